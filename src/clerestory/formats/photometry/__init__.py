"""Readers of photometric files, and emitting surfaces of luminaires."""
