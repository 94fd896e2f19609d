"""Geometry becomes a Bsdf by tracing a sample of it (genBSDF's job)."""
