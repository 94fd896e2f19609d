"""BSDFs of shading systems by tracing their geometry (as Radiance's genBSDF)."""
