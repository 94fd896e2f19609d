"""What a smooth coat reflects: more towards grazing angles, as Radiance has it."""

import drjit as dr

# A purely specular surface of at least this reflectance counts as a dielectric
# (normal.c of Radiance, FRESTHRESH).
_THRESHOLD = 0.017999

# Radiance 6.0's stand-in for Fresnel's formulas, exp(-5.85 cos) - c (normal.c, FRESNE)
_STEEPNESS, _OFFSET = 5.85, 0.00202943064


def grazing_share(specularity, smooth, cos_theta):
    """Share that a smooth coat adds to what the specularity leaves, 0…1."""
    share = dr.exp(-_STEEPNESS * cos_theta) - _OFFSET
    return dr.select(smooth & (specularity >= _THRESHOLD), share, 0)
