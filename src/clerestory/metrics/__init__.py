"""Daylight metrics of LM-83, EN 17037, LEED and BREEAM, and lighting energy."""
