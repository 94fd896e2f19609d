"""Physical and photometric constants, with their sources."""

import math

# Luminous efficacy of white light in Radiance [lm/W] (color.h: WHTEFFICACY)
LUMINOUS_EFFICACY = 179.0

# Default sky colour and ground reflectance of gendaymtx.
SKY_COLOUR = (0.960, 1.004, 1.118)
GROUND_REFLECTANCE = 0.2

# Angular diameter of the sun [rad]: 0.533°, as in Radiance's sky generators.
SUN_DIAMETER = math.radians(0.533)

# Text before the names of built-in BSDFs and spectra, in place of a file
LIBRARY_PREFIX = "library:"

# Increments of the two-dimensional R2 sequence of points (M. Roberts, 2018).
R2 = (0.7548776662466927, 0.5698402909980532)
