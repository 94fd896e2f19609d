"""Array types that annotations share.

Functions that relate several dimensions write their shapes out; these are the types of
functions whose arrays all have one leading shape.
"""

import numpy as np
from jaxtyping import Bool, Float, Int, Int32

# Unit vectors, one number each, one point of the unit square each
Directions = Float[np.ndarray, "*batch 3"]
Values = Float[np.ndarray, "*batch"]
Points2 = Float[np.ndarray, "*batch 2"]

# Whole numbers and truth values of the same leading shape
Indices = Int[np.ndarray, "*batch"]
Mask = Bool[np.ndarray, "*batch"]

# One vector in space, one in a plane
Vector = Float[np.ndarray, "3"]
Vector2 = Float[np.ndarray, "2"]

# Table from incident patches to exit patches
ExitIncident = Float[np.ndarray, "exit incident"]

# Spectral values, one per wavelength
PerWavelength = Float[np.ndarray, " wavelength"]

# Values and branches of a tensor tree
Slots = Int32[np.ndarray, " slots"]
