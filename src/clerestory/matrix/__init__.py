"""Matrices that know what their rows and columns stand for."""
