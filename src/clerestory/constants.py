"""Numbers of the field, each typed once, with its source."""

import math

# Radiance's luminous efficacy for white light [lm/W] (Radiance color.h: WHTEFFICACY).
LUMINOUS_EFFICACY = 179.0

# Default colour of sky and reflectance of ground in gendaymtx, gensky's documentation.
SKY_COLOUR = (0.960, 1.004, 1.118)
GROUND_REFLECTANCE = 0.2

# Apparent diameter of the sun [rad]: 0.533°, as in Radiance's sky generators.
SUN_DIAMETER = math.radians(0.533)
