"""Spectra in photometry: weighting functions, bands, α-opic quantities, daylight."""
