"""Radiance's generators run natively: from a command's words to scene text."""
