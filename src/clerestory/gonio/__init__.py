"""BSDFs from goniophotometer measurements: readers, lobe fits, interpolation."""
