"""Python implementations of Radiance's scene generators."""
