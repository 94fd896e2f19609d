"""Tensor trees against Radiance's library: values, integrals, resolution.

Radiance 6 multiplies the values of a BSDF by a factor within 2e-4 of 1 that depends
on the place of the cell alone, after it has taken the smallest value out as diffuse
light. A copy of the file with all values 1, too bright to be taken out, shows the
factors; with them taken back the values must agree to single precision.
"""

import re

import numpy as np
import pytest

from clerestory.bsdf.scattering import OTHER_SIDE
from clerestory.bsdf.xml import read_bsdf

library = pytest.importorskip("pyradiance.bsdf")

PAIRS = 10_000
# Radiance takes out diffuse light between these values [1/sr] (bsdf_t.c).
DIFFUSE = 0.01 / np.pi, 1.5 / np.pi
TRANSMITTED = library.SAMPLE_T | library.SAMPLE_SP | library.SAMPLE_DF
REFLECTED = library.SAMPLE_R | library.SAMPLE_SP | library.SAMPLE_DF
TREES = [
    "honeybee/clear_t4_4",
    "honeybee/tensortree",
    "pyradiance_tutorial/blindsT3",
    *(
        f"ignis/simple_tensor_{name}"
        for name in (
            "d2_line_refl",
            "d2_refl",
            "d2_t3_refl",
            "d2_t3_trans",
            "d2_trans",
            "d3_refl",
            "d3_t3_refl",
            "front_refl",
            "refl",
            "spot_refl",
            "spot_t3_trans",
            "spot_trans",
            "trans",
        )
    ),
]

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


def all_ones(path, copy):
    def ones(match):
        return match[1] + re.sub(rb"[^\s{},]+", b"1", match[2])

    data = path.read_bytes()
    copy.write_bytes(re.sub(rb"(<ScatteringData>)([^<]*)", ones, data))
    return copy


def without_ripple(theirs, factor, bsdf, incident, leaving):
    room, to_room = incident[:, 2] > 0, leaving[:, 2] > 0
    for channel, name in bsdf.functions:
        assert channel == "visible"
        least = bsdf.functions[channel, name].extrema()[0]
        least = least if DIFFUSE[0] < least < DIFFUSE[1] else 0.0
        back, through = name.endswith("back"), name.startswith("trans")
        pairs = (room == back) & ((room != to_room) == through)
        if through and ("visible", OTHER_SIDE[name]) not in bsdf.functions:
            pairs = room != to_room
        ripple = np.where(factor[pairs] > 0, factor[pairs], 1)
        theirs[pairs] = least + (theirs[pairs] - least) / ripple
    return theirs


@pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")
@pytest.mark.parametrize("name", TREES)
def test_values_of_random_pairs(shared_data, tmp_path, name):
    path = shared_data / "bsdf" / f"{name}.xml"
    bsdf = read_bsdf(path)
    incident, leaving = directions(PAIRS, 1), directions(PAIRS, 2)
    theirs = query(load(path), incident, leaving)
    copy = all_ones(path, tmp_path / f"ones_{path.name}")
    factor = query(load(copy), incident, leaving)
    assert np.all((np.abs(factor - 1) < 3e-4) | (factor == 0))
    truth = without_ripple(theirs, factor, bsdf, incident, leaving)
    ours = bsdf.evaluate(incident, leaving)
    np.testing.assert_allclose(ours, truth, rtol=1e-6, atol=1e-7)


@pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")
@pytest.mark.parametrize("name", TREES)
def test_direct_hemispherical_values(shared_data, name):
    path = shared_data / "bsdf" / f"{name}.xml"
    bsdf, data = read_bsdf(path), load(path)
    incident = directions(200, 3)
    for channel, function in bsdf.functions:
        back = function.endswith("back")
        source = incident[(incident[:, 2] > 0) == back]
        flags = TRANSMITTED if function.startswith("trans") else REFLECTED
        ours = bsdf.hemispherical(source, function=function, channel=channel)
        theirs = [library.direct_hemi(data, *i, flags) for i in angles_deg(source)]
        np.testing.assert_allclose(ours, theirs, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("name", TREES[:2])
def test_direct_hemispherical_values_by_reciprocity(shared_data, name):
    """Radiance does this for rank 4 only; for rank 3 it has nothing to say."""
    path = shared_data / "bsdf" / f"{name}.xml"
    bsdf, data = read_bsdf(path), load(path)
    assert ("visible", "transmission_front") not in bsdf.functions
    source = directions(400, 4)
    source = source[source[:, 2] < 0]
    ours = bsdf.hemispherical(source, function="transmission_front")
    theirs = [library.direct_hemi(data, *i, TRANSMITTED) for i in angles_deg(source)]
    np.testing.assert_allclose(ours, theirs, rtol=1e-5, atol=1e-7)


@pytest.mark.parametrize("name", TREES[:3])
def test_resolution_of_pairs(shared_data, name):
    """`bsdf.size2`: projected solid angle of the cell that holds a pair."""
    path = shared_data / "bsdf" / f"{name}.xml"
    bsdf, data = read_bsdf(path), load(path)
    incident, leaving = directions(1000, 5), directions(1000, 6)
    through = (incident[:, 2] > 0) != (leaving[:, 2] > 0)
    incident, leaving = incident[through], leaving[through]
    pairs = zip(angles_deg(incident), angles_deg(leaving), strict=True)
    theirs = [np.max(library.size2(data, *i, *o, library.QUERY_MAX)) for i, o in pairs]
    np.testing.assert_allclose(bsdf.resolution(incident, leaving), theirs, rtol=1e-6)
