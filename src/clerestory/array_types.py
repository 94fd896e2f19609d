"""Array types for type annotations.

Functions whose arrays all have the same batch shape use these types; other functions
annotate the shape of each array.
"""

import numpy as np
from jaxtyping import Bool, Float, Int, Int32

# Unit vectors, numbers, and points of the unit square, in batches of any shape
Directions = Float[np.ndarray, "*batch 3"]
Values = Float[np.ndarray, "*batch"]
Points2 = Float[np.ndarray, "*batch 2"]

# Integers and booleans, in batches of any shape
Indices = Int[np.ndarray, "*batch"]
Mask = Bool[np.ndarray, "*batch"]

# A single vector in space, and a single vector in a plane
Vector = Float[np.ndarray, "3"]
Vector2 = Float[np.ndarray, "2"]

# One value per time step, and one per pixel of a picture
Series = Float[np.ndarray, " time"]
Image = Float[np.ndarray, "row column"]
EachImage = Float[np.ndarray, "_ _"]  # one of several images of different size
Pictures = Float[np.ndarray, "picture row column"]
EachGroup = Float[np.ndarray, "_ row column"]  # one of several groups of pictures
ImageMask = Bool[np.ndarray, "row column"]
PictureMasks = Bool[np.ndarray, "picture row column"]

# Vertices of a polygon or mesh in space and in a plane, and vertex indices of triangles
Vertices = Float[np.ndarray, "vertices 3"]
Vertices2 = Float[np.ndarray, "vertices 2"]
Faces = Int[np.ndarray, "triangles 3"]

# One vector per ray, and one number per ray
RayVectors = Float[np.ndarray, "rays 3"]
RayValues = Float[np.ndarray, " rays"]

# Matrix of a BSDF: exit patches by incident patches
ExitIncident = Float[np.ndarray, "exit incident"]

# One value per wavelength
PerWavelength = Float[np.ndarray, " wavelength"]

# Leaf values and branch nodes of a tensor tree
Slots = Int32[np.ndarray, " slots"]
