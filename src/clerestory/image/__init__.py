"""Radiance pictures: files, arithmetic, false colour, tone mapping, HDR capture."""
