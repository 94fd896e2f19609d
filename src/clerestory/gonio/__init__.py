"""Measured scattering becomes a Bsdf: goniophotometer files, lobes, mesh, transport."""
