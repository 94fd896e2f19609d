"""BSDFs of shading systems by ray tracing, as in Radiance's genBSDF."""
