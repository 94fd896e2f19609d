"""Uncertainty of results from what is known about a building."""
