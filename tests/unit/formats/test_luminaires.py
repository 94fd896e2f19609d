"""Luminaires: what files say, how much light that is, and the surfaces that send it."""

import warnings

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.formats.photometry.luminaire import Luminaire, LuminousShape
from clerestory.formats.photometry.luminaire_scene import luminaire_scene, panel_scene
from clerestory.formats.photometry.read import read_luminaire
from clerestory.scene.model import Cone, Polygon, Ring, Sphere

ANGLES = np.linspace(0, 180, 181)
DISC = LuminousShape("cylinder", 0.2, 0.2, 0.0)
VERSIONS = {
    1986: "an old file",
    1991: "IESNA91",
    1995: "IESNA:LM-63-1995",
    2002: "IESNA:LM-63-2002",
    2019: "IES:LM-63-2019",
}


def rotational(intensity, angles=ANGLES, shape=DISC):
    return Luminaire("lamp", "C", np.zeros(1), angles, intensity[None], shape)


def directions(count=400, seed=4):
    rays = np.random.default_rng(seed).normal(size=(count, 3))
    return rays / np.linalg.norm(rays, axis=1, keepdims=True)


@pytest.fixture
def ies(tmp_path):
    def read(
        *,
        year=2002,
        lamps="1 -1",
        multiplier=1.0,
        kind=1,
        units=2,
        size="-.2 -.2 0",
        factors="1 1 10",
        vertical=(0, 45, 90),
        horizontal=(0,),
        table=None,
        tilt="NONE",
    ):
        count = len(vertical) * len(horizontal)
        table = range(1, count + 1) if table is None else table
        words = [
            f"{lamps} {multiplier} {len(vertical)} {len(horizontal)} {kind} {units}",
            f"{size} {factors}",
            *(" ".join(map(str, row)) for row in (vertical, horizontal, table)),
        ]
        text = f"{VERSIONS[year]}\n[LUMCAT] X1\n[MORE] and more\nTILT={tilt}\n"
        (tmp_path / "lamp.ies").write_text(text + "\n".join(words) + "\n")
        return read_luminaire(tmp_path / "lamp.ies")

    return read


def test_even_intensity_fills_the_sphere():
    assert rotational(np.full(181, 2.0)).flux() == pytest.approx(8 * np.pi)


def test_flux_is_exact_for_intensities_linear_in_the_angle():
    """∫ 2π θ sin θ dθ from 0 to π/2 is 2π, whatever the steps."""
    angles = np.array([0.0, 20.0, 37.0, 90.0])
    assert rotational(np.radians(angles), angles).flux() == pytest.approx(2 * np.pi)


@pytest.mark.parametrize("kind", [2, 3])
def test_flux_of_types_a_and_b(ies, kind):
    """An even 1 cd over the half space is 2π lm."""
    lamp = ies(kind=kind, vertical=(-90, 0, 90), horizontal=(0, 90), table=[1] * 6)
    assert lamp.flux() == pytest.approx(2 * np.pi)


@pytest.mark.parametrize("kind", [1, 2, 3])
def test_flux_is_that_of_the_intensity_in_all_directions(ies, kind):
    """Against the sum over 200,000 directions, evenly spread."""
    lamp = ies(kind=kind, vertical=(0, 30, 90), horizontal=(0, 45, 90))
    i = np.arange(200_000)
    z = 1 - (2 * i + 1) / len(i)
    turn = np.pi * (3 - np.sqrt(5)) * i
    flat = np.sqrt(1 - z**2)
    rays = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=1)
    total = 4 * np.pi * lamp.candela(rays).mean()
    assert lamp.flux() == pytest.approx(total, rel=1e-3)


def test_angles_lie_where_the_types_say():
    """The plane of 0° towards +x for type C; the two circles cross at the nadir."""
    down, east, north = (
        np.array([0.0, 0, -1]),
        np.array([1.0, 0, 0]),
        np.array([0, 1.0, 0]),
    )
    lean = (down + east) / np.sqrt(2)
    side = (down - north) / np.sqrt(2)
    table = {"C": np.zeros((2, 2)), "A": np.zeros((1, 2)), "B": np.zeros((1, 2))}
    lamps = {
        kind: Luminaire(
            "x",
            kind,
            np.array([0.0, 360.0]) if kind == "C" else np.zeros(1),
            np.array([0.0, 90.0]),
            table[kind],
            DISC,
        )
        for kind in "ABC"
    }
    at = {
        k: [np.round(lamp.angles(d), 6).tolist() for d in (lean, side)]
        for k, lamp in lamps.items()
    }
    assert at["C"] == [[0.0, 45.0], [270.0, 45.0]]
    assert at["B"] == [[0.0, 45.0], [45.0, 0.0]]
    assert at["A"] == [[0.0, 45.0], [45.0, 0.0]]


def test_types_a_and_b_differ_off_their_axes():
    """Out of both planes, A's vertical and B's horizontal angle are the latitudes."""
    ray = np.array([0.6, -0.48, -0.64])
    angles, table = np.array([-90.0, 90.0]), np.zeros((1, 2))
    a = Luminaire("a", "A", np.zeros(1), angles, table, DISC).angles(ray)
    b = Luminaire("b", "B", np.zeros(1), angles, table, DISC).angles(ray)
    assert np.sin(np.radians(a[1])) == pytest.approx(0.6)
    assert np.tan(np.radians(a[0])) == pytest.approx(0.48 / 0.64)
    assert np.sin(np.radians(b[0])) == pytest.approx(0.48)
    assert np.tan(np.radians(b[1])) == pytest.approx(0.6 / 0.64)


def test_files_have_their_factors(ies):
    """Multiplier and ballast factor always, the ballast-lamp factor before 1995."""
    for year in VERSIONS:
        lamp = ies(
            year=year, lamps="2 1500", multiplier=2, factors=".5 .8 36", size="0 0 0"
        )
        expected = 2 * 0.5 * (0.8 if year < 1995 else 1.0)
        assert lamp.intensity[0].tolist() == [expected, 2 * expected, 3 * expected]
        assert (lamp.lamp_lumens, lamp.watts) == (3000, 36)
        assert lamp.keywords["LUMCAT"] == "X1 and more"
    assert ies().lamp_lumens is None


QUADRANT = {"horizontal": (0, 45, 90), "table": [9, 1, 0, 9, 2, 0, 9, 4, 0]}
HALF = {"horizontal": (0, 90, 180), "table": [9, 1, 0, 9, 2, 0, 9, 4, 0]}


@pytest.mark.parametrize(
    ("given_in", "expected"),
    [
        (QUADRANT, [1, 2, 4, 2, 1, 2, 4, 2]),
        (HALF, [1, 1.5, 2, 3, 4, 3, 2, 1.5]),
        ({**HALF, "horizontal": (90, 180, 270)}, [2, 1.5, 1, 1.5, 2, 3, 4, 3]),
        ({**HALF, "horizontal": (0, 180, 360), "table": [9, 4, 0, 9, 2, 0, 9, 4, 0]},
         [4, 3.5, 3, 2.5, 2, 2.5, 3, 3.5]),
    ],
)  # fmt: skip
def test_symmetric_tables_are_unfolded(ies, given_in, expected):
    """Intensity at 45° from the nadir, every 45° around; between planes linear."""
    lamp = ies(**given_in)
    turn = np.radians(np.arange(0, 360, 45))
    low = np.sqrt(0.5)
    rays = np.stack([low * np.cos(turn), low * np.sin(turn), np.full(8, -low)], axis=1)
    np.testing.assert_allclose(lamp.candela(rays), expected, atol=1e-9)


def test_no_light_leaves_beyond_the_table(ies):
    assert ies(table=[5, 5, 5]).candela(np.array([0.6, 0.0, 0.8])) == 0


@pytest.mark.parametrize(
    ("year", "size", "kind", "extents"),
    [
        (2002, "0 0 0", "sphere", (0.001, 0.001, 0.001)),
        (2002, ".3 1.2 0", "box", (1.2, 0.3, 0)),
        (1986, ".3 1.2 .1", "box", (1.2, 0.3, 0.1)),
        (2002, "-.2 -.2 0", "cylinder", (0.2, 0.2, 0)),
        (1991, "-.2 0 0", "cylinder", (0.2, 0.2, 0)),
        (1995, "-.2 0 .1", "cylinder", (0.2, 0.2, 0.1)),
        (2019, "-.2 -.2 .1", "cylinder", (0.2, 0.2, 0.1)),
        (2002, "-.2 -.2 -.2", "sphere", (0.2, 0.2, 0.2)),
        (1995, "-.2 0 -.2", "sphere", (0.2, 0.2, 0.2)),
        (2002, "-.1 1.2 -.1", "box", (1.2, 0.1, 0.1)),
    ],
)
def test_signs_of_sizes_mean_what_each_version_says(ies, year, size, kind, extents):
    shape = ies(year=year, size=size).shape
    assert shape.kind == kind
    np.testing.assert_allclose((shape.x, shape.y, shape.z), extents)


def test_feet_become_metres(ies):
    assert ies(units=1, size="1 2 0").shape.x == pytest.approx(0.6096)


def test_tilt_dims_a_tilted_lamp(ies):
    lamp = ies(tilt="INCLUDE\n1\n3\n0 45 90\n1 .9 .6")
    assert lamp.tilt.at(0) == 1
    level, tilted = (
        luminaire_scene(lamp, tilt_deg=angle).materials["luminaire"].pattern
        for angle in (0, 22.5)
    )
    assert tilted.luminaire.intensity[0, 0] / level.luminaire.intensity[0, 0] == (
        pytest.approx(0.95)
    )
    lying = ies(tilt="INCLUDE\n2\n2\n0 90\n1 .5")
    with pytest.raises(InputError, match="horizontal lamps"):
        luminaire_scene(lying, tilt_deg=10)


def ldt(
    symmetry, planes, table, *, lumens=2000.0, shape="0\n0\n0\n600\n300\n0\n0\n0\n0"
):
    angles = [360 / planes * i for i in range(planes)]
    lines = ["Maker", "1", symmetry, planes, "0", "3", "45", "", "Name", "No", "f", "d"]
    lines += [
        *shape.split(),
        "100",
        "80",
        "1",
        "0",
        "1",
        "1",
        "LED",
        lumens,
        "",
        "",
        "30",
    ]
    lines += [0] * 10 + angles + [0, 45, 90] + table
    return "\n".join(map(str, lines)) + "\n"


@pytest.mark.parametrize(
    ("symmetry", "rows", "expected"),
    [
        (0, [1, 2, 3, 4], [1, 2, 3, 4]),
        (1, [5], [5, 5, 5, 5]),
        (2, [1, 2, 3], [1, 2, 3, 2]),
        (3, [1, 2, 3], [2, 3, 2, 1]),
        (4, [1, 2], [1, 2, 1, 2]),
    ],
)
def test_eulumdat_has_five_symmetries(tmp_path, symmetry, rows, expected):
    """Four C planes; intensities are per 1000 lm of 2000."""
    table = [value for row in rows for value in (9, row, 0)]
    (tmp_path / "a.ldt").write_text(ldt(symmetry, 4, table))
    lamp = read_luminaire(tmp_path / "a.ldt")
    low = np.sqrt(0.5)
    rays = low * np.array([[1, 0, -1], [0, 1, -1], [-1, 0, -1], [0, -1, -1]])
    np.testing.assert_allclose(lamp.candela(rays), 2 * np.array(expected), atol=1e-9)
    assert lamp.lamp_lumens == 2000


def test_more_light_than_the_lamps_have_is_doubted(ies):
    with pytest.warns(ClerestoryWarning, match=r"628 lm, 6283% of the 10 lm"):
        ies(lamps="1 10", table=[100, 100, 100])


def test_the_length_of_eulumdat_lies_along_y(tmp_path):
    (tmp_path / "a.ldt").write_text(ldt(1, 1, [1, 1, 1]))
    shape = read_luminaire(tmp_path / "a.ldt").shape
    assert (shape.kind, shape.x, shape.y) == ("box", 0.3, 0.6)
    (tmp_path / "a.ldt").write_text(
        ldt(1, 1, [1, 1, 1], shape="9\n9\n9\n200\n0\n5\n5\n5\n5")
    )
    shape = read_luminaire(tmp_path / "a.ldt").shape
    assert (shape.kind, shape.x, shape.z) == ("cylinder", 0.2, 0.005)


SHAPES = [
    (LuminousShape("box", 1.2, 0.3, 0.0), 90, [Polygon]),
    (LuminousShape("box", 1.2, 0.3, 0.1), 90, [Polygon]),
    (LuminousShape("box", 1.2, 0.3, 0.1), 180, [Polygon] * 6),
    (LuminousShape("box", 1.2, 0.3, 0.0), 180, [Polygon] * 2),
    (LuminousShape("cylinder", 0.4, 0.4, 0.0), 90, [Ring]),
    (LuminousShape("cylinder", 0.4, 0.4, 0.3), 180, [Ring, Ring, Cone]),
    (LuminousShape("sphere", 0.3, 0.3, 0.3), 180, [Sphere]),
]


@pytest.mark.parametrize(("shape", "highest", "kinds"), SHAPES)
def test_surfaces_send_the_intensity_of_the_file(shape, highest, kinds):
    """Radiance times projected area, summed over the surfaces that face a viewer."""
    angles = np.linspace(0, highest, 19)
    lamp = rotational(100 * np.cos(np.radians(angles) / 2), angles, shape)
    scene = luminaire_scene(
        lamp, position=(3.0, 2.0, 1.0), turn_deg=30.0, tilt_deg=20.0
    )
    assert [type(surface) for surface in scene.surfaces] == kinds
    rays = directions(60)
    pattern = scene.materials["luminaire"].pattern
    shown = pattern.value(rays)[:, 1] * 179
    area = sum(projected(surface, rays) for surface in scene.surfaces)
    # Into the luminaire's frame: back by the turn, then by the tilt
    turn, tilt = np.radians(30), np.radians(20)
    x = rays[:, 0] * np.cos(turn) + rays[:, 1] * np.sin(turn)
    y = -rays[:, 0] * np.sin(turn) + rays[:, 1] * np.cos(turn)
    z = rays[:, 2]
    local = np.stack(
        [x, y * np.cos(tilt) + z * np.sin(tilt), z * np.cos(tilt) - y * np.sin(tilt)],
        axis=1,
    )
    np.testing.assert_allclose(shown * area, lamp.candela(local), rtol=1e-9, atol=1e-9)


def projected(surface, rays):
    """Area of a convex surface's front as seen against the rays."""
    match surface:
        case Polygon():
            a, b, c = surface.vertices[:3]
            return np.maximum(rays @ np.cross(b - a, c - b), 0)
        case Ring():
            return (
                np.maximum(rays @ surface.normal, 0) * np.pi * surface.outer_radius**2
            )
        case Sphere():
            return np.full(len(rays), np.pi * surface.radius**2)
        case Cone():
            axis = surface.top - surface.base
            across = np.linalg.norm(np.cross(rays, axis), axis=1)
            return 2 * surface.base_radius * across


def test_dimming_and_colour_scale_the_light():
    lamp = rotational(np.full(181, 10.0))
    scene = luminaire_scene(lamp, dimming=0.25, colour=(2.0, 1.0, 0.5))
    light = scene.materials["luminaire"]
    assert light.pattern.luminaire.flux() == pytest.approx(10 * np.pi)
    assert light.radiance @ (0.265, 0.670, 0.065) == pytest.approx(1)
    assert light.radiance[0] / light.radiance[1] == pytest.approx(2)


def test_a_panel_sends_its_flux():
    """A Lambertian area A of radiance L sends π A L · 179 lm."""
    corners = np.array([[0.0, 0, 2], [0, 0.6, 2], [1.2, 0.6, 2], [1.2, 0, 2]])
    light = panel_scene(corners, lumens=3000).materials["panel"]
    assert light.radiance[1] * np.pi * 0.72 * 179 == pytest.approx(3000)


@pytest.mark.parametrize(
    ("name", "text", "message"),
    [
        ("a.ies", "nothing", "no line TILT="),
        ("a.ies", "TILT=NONE\n1 2 x", '3: "x" is found where'.replace("3", "2")),
        ("a.ies", "TILT=gone.dat\n", "1: TILT=gone.dat"),
        ("a.ies", "TILT=NONE\n1 1 1 2 1 9 1\n", "photometric type is 9"),
        ("a.ies", "TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 0 0 1 1", "vertical angles"),
        ("a.ies", "TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 1", "file ends"),
        ("a.ies", "TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 1 -1", "-1 cd"),
        (
            "a.ies",
            "TILT=NONE\n1 1 1 2 2 1 2 0 0 0 1 1 1 0 90 0 50 1 1 1 1",
            "0 to 90, 180",
        ),
        ("a.ldt", "Maker\n1\n7\n", "3: the symmetry is 7"),
        ("a.ldt", "Maker\n", "file ends where"),
    ],
)
def test_broken_files_are_refused(tmp_path, name, text, message):
    (tmp_path / name).write_text(text)
    with pytest.raises(InputError) as caught:
        read_luminaire(tmp_path / name)
    assert message in str(caught.value)
    assert name in str(caught.value)


WORDS = "0 1 2 3 -1 90 45 180 1e9 nan x , 360 NONE TILT=NONE"
NUMBERS = st.sampled_from(WORDS.split(" "))


@settings(max_examples=150, suppress_health_check=list(HealthCheck), deadline=None)
@given(st.sampled_from(["any.ies", "any.ldt"]), st.lists(NUMBERS, max_size=60))
def test_any_numbers_are_read_or_refused(tmp_path_factory, name, words):
    file = tmp_path_factory.getbasetemp() / name
    file.write_text("TILT=NONE\n" * (name == "any.ies") + "\n".join(words))
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", ClerestoryWarning)
            read_luminaire(file).flux()
    except InputError as error:
        message = str(error)
    else:
        message = ""
    assert "\n" not in message
