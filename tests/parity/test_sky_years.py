"""Whole years of six climates against gendaymtx: all fineness, all options.

Bounds: every patch within 0.5 % or 10⁻³ of the dome's mean; irradiance on the
horizontal and on four vertical planes, and that of the sun, within 0.2 %.
`benchmarks/sky_parity.py` prints how far within.
"""

import numpy as np
import pytest
from scipy.spatial import cKDTree

pytest.importorskip("pyradiance")
from gendaymtx import Distance, distance, epw_to_wea, gendaymtx

from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather

pytestmark = pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")

CLIMATES = [
    "Oslo",
    "NLD_Amsterdam062400_IWEC",
    "barcelona",
    "denver",
    "mannheim",
    "chicago",
]
OPTIONS = {
    "": {},
    "-d": {"include": "sun"},
    "-s": {"include": "sky"},
    "-d -5 .533": {"include": "sun", "sun": "disc", "sun_diameter_deg": 0.533},
    "-5 .533": {"sun": "disc", "sun_diameter_deg": 0.533},
    "-O1": {"spectrum": "solar"},
    "-g .1 .35 .02": {"ground_reflectance": (0.1, 0.35, 0.02)},
    "-c 1 .9 .7": {"sky_colour": (1, 0.9, 0.7)},
    "-r 33": {"rotation_deg": 33.0},
}


@pytest.fixture(scope="module", params=CLIMATES)
def year(request, shared_data, tmp_path_factory):
    """The WEA file of a year."""
    wea = tmp_path_factory.mktemp("wea") / "year.wea"
    epw_to_wea(shared_data / "weather" / f"{request.param}.epw", wea)
    return wea


def ties(weather, partition, arguments):
    """Steps whose last patch for the sun could be either of two, to rounding.

    In a whole year of Mannheim at MF 5 there is one: patches 396 and 547.
    """
    count = 1 if arguments.get("sun") == "disc" else 4
    sun = sun_over(
        weather,
        sun_formula="radiance",
        rotation_deg=arguments.get("rotation_deg", 0.0),
    )
    tree = cKDTree(partition.dome.centres())
    distance, _ = tree.query(sun.directions(), k=count + 1)
    close = distance[:, count] - distance[:, count - 1] < 1e-6
    return close & (weather.direct_normal > 0)


def assert_close(wea, subdivision, options, arguments):
    sky = sky_matrix(
        read_weather(wea), subdivision=subdivision, sun_formula="radiance", **arguments
    )
    theirs = gendaymtx(wea, "-m", str(subdivision), *options.split())
    tied = ties(read_weather(wea), sky.partition, arguments)
    assert tied.sum() < 5
    found = Distance(0, 0, 0)
    for steps in np.array_split(np.flatnonzero(~tied), 24):
        ours = sky.select(steps).values
        found = found.worse(distance(ours, theirs[:, :, steps], sky.partition))
    assert found.patch <= 1
    assert found.plane <= 0.002
    assert found.direct <= 0.002


@pytest.mark.slow
@pytest.mark.parametrize("subdivision", [1, 2, 3, 4, 5, 6])
def test_years_equal_gendaymtx_in_patches_and_planes(year, subdivision):
    assert_close(year, subdivision, "", {})


@pytest.mark.slow
@pytest.mark.parametrize("options", OPTIONS)
def test_options_mean_the_same_for_whole_years(year, options):
    assert_close(year, 2, options, OPTIONS[options])


def written_in(units, wea):
    """The same file with direct horizontal irradiance, or in lux."""
    lines = wea.read_text().splitlines()
    head = [line.replace("units 1", f"units {units}") for line in lines[:6]]
    rows = [line.split() for line in lines[6:]]
    if units == 3:
        rows = [[*r[:3], str(100 * float(r[3])), str(120 * float(r[4]))] for r in rows]
    path = wea.with_name(f"units{units}.wea")
    path.write_text("\n".join([*head, *map(" ".join, rows)]) + "\n")
    return path


def test_illuminance_in_sends_the_same_illuminance_out(shared_data, tmp_path):
    """Shapes may differ where the efficacy allows two skies, sums may not."""
    wea = tmp_path / "year.wea"
    epw_to_wea(shared_data / "weather" / "geneva.epw", wea)
    lux = written_in(3, wea)
    sky = sky_matrix(read_weather(lux), subdivision=1, sun_formula="radiance")
    theirs = gendaymtx(lux, "-m", "1")
    x, y, z = sky.partition.dome.centres().T
    weight = sky.partition.dome.solid_angles()
    ours, peer = (weight * z @ part[1, 1:] for part in (sky.values, theirs))
    lit = peer > 1
    assert lit.sum() > 4000
    np.testing.assert_allclose(ours[lit], peer[lit], rtol=2e-3)

    # The shape, where both found the same sky
    east = weight * np.maximum(x, 0)
    ratio = (east @ sky.values[1, 1:])[lit] / (east @ theirs[1, 1:])[lit]
    assert np.mean(np.abs(ratio - 1) < 0.01) > 0.5
    assert y.size == 145
