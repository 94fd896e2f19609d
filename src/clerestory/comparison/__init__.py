"""Comparison of measured with simulated time series."""
