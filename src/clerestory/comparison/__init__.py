"""Comparison of measured and simulated time series."""
