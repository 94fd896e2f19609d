"""Glare sources in pictures and the glare indices computed from them."""
