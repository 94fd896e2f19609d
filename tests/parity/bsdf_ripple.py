"""Radiance's BSDF library without the ripple it puts on values.

Radiance 6 multiplies the values of a BSDF by factors within 3e-4 of 1 that depend on
the place of the value alone, after it has taken the smallest value out as diffuse
light. A copy of the file with ones for values shows the factors; with them taken
back what remains must agree to single precision. The first value of a matrix is zero
in the copy, for ones would be taken out as diffuse light; its factor stays unknown.
"""

import re

import numpy as np
import pytest

from clerestory.bsdf.scattering_function import OTHER_SIDE
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems

library = pytest.importorskip("pyradiance.bsdf")

# Radiance takes out diffuse light above this, from trees up to 1.5/π [1/sr].
LEAST_DIFFUSE, MOST_DIFFUSE_OF_TREES = 0.01 / np.pi, 1.5 / np.pi

# Radiance keeps what it loads in a list of its own; Python must not free it meanwhile
LOADED = []


def load(path):
    LOADED.append(library.load_file(str(path)))
    return LOADED[-1]


def angles_deg(direction):
    x, y, z = np.moveaxis(direction, -1, 0)
    theta, phi = np.arctan2(np.hypot(x, y), z), np.arctan2(y, x)
    return np.degrees(np.stack([theta, phi], axis=-1)).tolist()


def directions(count, seed):
    v = np.random.default_rng(seed).normal(size=(count, 3))
    return v / np.linalg.norm(v, axis=1, keepdims=True)


def query(data, incident, leaving):
    pairs = zip(angles_deg(incident), angles_deg(leaving), strict=True)
    return np.array([library.query(data, *i, *o)[1] for i, o in pairs])


def is_dropped(part):
    """Whether Radiance drops a function, and takes the other side's in reverse."""
    incident = klems("full").centres() * [-1, -1, 1]
    return part.hemispherical(incident).max() <= 1e-3


def values(path, bsdf, incident, leaving, *, folder):
    """Radiance's values without ripple, and for which pairs they are known."""
    theirs = query(load(path), incident, leaving)
    copy = _ones(path, folder / f"ones_{path.name}")
    factor = query(load(copy), incident, leaving)
    known = np.ones(len(theirs), dtype=bool)
    room, to_room = incident[:, 2] > 0, leaving[:, 2] > 0
    for (channel, name), part in bsdf.functions.items():
        if channel != "visible":
            continue
        back, through = name.endswith("back"), name.startswith("trans")
        pairs = (room == back) & ((room != to_room) == through)
        if through and ("visible", OTHER_SIDE[name]) not in bsdf.functions:
            pairs = room != to_room
        if is_dropped(part):
            other = bsdf.functions.get(("visible", OTHER_SIDE.get(name)))
            known[pairs] = part.extrema()[1] == 0 and other is None
            continue
        least = part.extrema()[0]
        matrix = isinstance(part, ScatteringMatrix)
        if least <= LEAST_DIFFUSE or (not matrix and least >= MOST_DIFFUSE_OF_TREES):
            least = 0.0
        seen = factor > 0.5
        known[pairs & ~seen & (theirs > 0)] = False
        pairs = pairs & seen
        assert np.all(np.abs(factor[pairs] - 1) < 3.1e-4)
        theirs[pairs] = least + (theirs[pairs] - least) / factor[pairs]
    return theirs, known


def _ones(path, copy):
    def ones(match):
        text = re.sub(rb"[^\s{},]+", b"1", match[2])
        return match[1] + (text if b"{" in text else text.replace(b"1", b"0", 1))

    data = path.read_bytes()
    copy.write_bytes(re.sub(rb"(<ScatteringData>)([^<]*)", ones, data))
    return copy
