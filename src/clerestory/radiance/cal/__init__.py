"""Radiance's function language (calcomp), vectorized and with limited work."""
