"""Glare sources in pictures and the indices made of them."""
