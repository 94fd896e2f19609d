"""Luminaires: photometric files and the emitting surfaces of their luminaires."""
