"""BSDFs of window layers: Klems matrices and tensor trees, in LBNL's XML format."""
