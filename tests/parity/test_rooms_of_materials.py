"""Rooms of every material: sensors read what rtrace reads.

Light of a sky or a sun reaches the sensors through and by way of the material; or that
of a window in the south, in which case the rows of a view matrix say how much.
"""

import numpy as np
import pytest
from material_rooms import (
    BOX,
    DIRECTION,
    LIGHT,
    POSITION,
    WIDE,
    WINDOW,
    seen_by_radiance,
)
from material_texts import SHEETS
from radiance import run

import clerestory as cl
from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors

# Sheets whose mirror image of a `light` is left out by rtrace: rays that descend from
# its ambient calculation do not count lights (m_light.c, badcomponent), as shown below
MIRRORED = {"smooth metal", "smooth trans", "glass", "dense glass", "BRTDfunc"}


def highlight(name):
    """Samples of highlights: of metals rtrace is to take many after a bounce too."""
    return 20_000 if name.startswith("metal") else 32


@pytest.mark.slow
@pytest.mark.parametrize(
    ("name", "light"),
    # The sun in smooth plastic has a test of its own below
    [(n, k) for n in SHEETS for k in LIGHT if (n, k) != ("smooth plastic", "sun")],
)
def test_sensors_read_what_rtrace_reads(tmp_path, name, light):
    """Within 2 % and the noise of both.

    The 2 % are for rough materials: rays after a bounce weigh too little for rtrace to
    take several samples of a highlight, and single ones it does not weight by its
    model, so they bring a few per cent more at grazing angles.
    """
    # A wide glow, to which rtrace traces no shadow rays, takes a bounce more
    chance = light == "sun" and name in MIRRORED
    file = tmp_path / "room.rad"
    file.write_text("\n".join([SHEETS[name], BOX, WIDE if chance else LIGHT[light]]))
    ours = irradiance(
        cl.read_rad(file),
        Sensors(POSITION, DIRECTION),
        samples=1 << 16,
        bounces=2,
        seed=1,
        device="cpu",
    )
    truth, spread = seen_by_radiance(
        tmp_path,
        "room.rad",
        bounces=3 if chance else 2,
        highlight=highlight(name),
        divisions=16384 if chance else 1024,
    )
    error = np.hypot(ours.error, spread)
    assert np.median(error / truth) < 0.01
    difference = np.abs(ours.irradiance - truth)
    assert np.all(difference < 4 * error + 0.02 * truth)
    total = ours.irradiance.sum() / truth.sum()
    assert abs(total - 1) < 0.02


@pytest.mark.parametrize(
    "sheet", ["glass m 0 0 3 .9 .8 .7", "metal m 0 0 5 .7 .6 .5 1 0"]
)
def test_rtrace_counts_no_light_mirrored_after_a_bounce(tmp_path, sheet):
    """Neither the weights, thresholds nor numbers of rays decide, but the light's type.

    Seen from the sensor, the sun's image in the sheet has its radiance; the sensor's
    irradiance from the same image is 0 for a `light`, but not for a `glow`.
    """
    wall = "m polygon wall 0 0 12 -50 2 -50 50 2 -50 50 2 50 -50 2 50"
    for kind in ("light sun 0 0 3 1 1 1", "glow sun 0 0 4 1 1 1 0"):
        sun = f"void {kind}\nsun source sun 0 0 4 0 -.8 .6 10"
        (tmp_path / "s.rad").write_text(f"void {sheet}\n{wall}\n{sun}")
        seen = {}
        for options, ray in (
            ("-ab 0", "0 .8 .6"),
            ("-I -ab 1 -ad 30000 -as 0 -aa 0", "0 1 0"),
            ("-I -ab 1 -ad 30000 -as 0 -aa 0 -ds .01 -dr 6 -u- -ss 10", "0 1 0"),
        ):
            every = f"rtrace -h -w -lr -20 -lw 1e-9 -st 0 -dt 0 {options} s.oct"
            text = run(
                f"oconv s.rad > s.oct; {every}", folder=tmp_path, stdin=f"0 0 0 {ray}"
            )
            seen[options] = np.fromstring(text, sep=" ")
        image, *sensor = seen.values()
        assert np.all(image > 0.01)
        expected = image * 0.8 * np.pi * np.sin(np.radians(5)) ** 2
        for found in sensor:
            if kind.startswith("light"):
                assert np.all(found == 0)
            else:
                assert np.allclose(found, expected, rtol=0.15)


@pytest.mark.slow
def test_a_sun_mirrored_by_smooth_plastic(tmp_path):
    """Sensors read what rtrace reads, and the mirrored sun that rtrace leaves out.

    A `glow` in place of the `light` is no reference here: to lights the coat reduces
    the diffuse part by its reflectance at the angle of incidence too.
    """
    file = tmp_path / "room.rad"
    sun = "void light sun 0 0 3 700 700 700\nsun source sun 0 0 4 .3 -.5 .6 10\n"
    file.write_text("\n".join([SHEETS["smooth plastic"], BOX, sun]))
    ours = irradiance(
        cl.read_rad(file),
        Sensors(POSITION, DIRECTION),
        samples=1 << 17,
        bounces=2,
        seed=1,
        device="cpu",
    )
    seen, spread = seen_by_radiance(tmp_path, "room.rad", bounces=2, jitter=1)
    mirrored, noise = mirrored_sun(bounces=2)
    assert np.all(mirrored[1:] > 0.03 * seen[1:])
    error = np.sqrt(ours.error**2 + spread**2 + noise**2)
    assert np.median(error / seen) < 0.01
    assert np.all(np.abs(ours.irradiance - seen - mirrored) < 4 * error + 0.005 * seen)


def mirrored_sun(*, bounces, paths=3_000_000, parts=60):
    """Irradiance of the sensors by paths that a smooth coat mirrors into the sun.

    Counted one by one. The plastic of west wall and roof (colour, specularity .05) has
    the coat of normal.c: exp(-5.85 cos) - .00203 of what is not reflected anyway.
    """
    random = np.random.default_rng(1)
    colour, grey = np.array([0.5, 0.4, 0.3]), np.full(3, 0.5)
    to_sun = np.array([0.3, -0.5, 0.6]) / np.linalg.norm([0.3, -0.5, 0.6])
    count = paths // parts
    found = np.zeros((parts, len(POSITION), 3))
    for part, sensor in np.ndindex(parts, len(POSITION)):
        point = np.repeat(POSITION[sensor : sensor + 1], count, axis=0)
        ray = diffuse(np.repeat(DIRECTION[sensor : sensor + 1], count, axis=0), random)
        weight, met = np.full((count, 3), np.pi), np.zeros(count, int)
        mirror = np.zeros(count, bool)
        while len(point):
            point, normal, opening, plastic = wall_of_box(point, ray)
            sunlit = opening & mirror & (ray @ to_sun >= np.cos(np.radians(5)))
            found[part, sensor] += 700 * weight[sunlit].sum(axis=0) / count
            cosine = -np.sum(ray * normal, axis=1)
            coat = 0.05 + 0.95 * (np.exp(-5.85 * cosine) - 0.00202943064)
            mirror = plastic & (random.random(len(point)) < coat)
            met = met + ~mirror
            weight = np.where(
                mirror[:, None],
                weight,
                weight * np.where(plastic[:, None], colour, grey),
            )
            ray = np.where(
                mirror[:, None],
                ray + 2 * cosine[:, None] * normal,
                diffuse(normal, random),
            )
            kept = ~opening & (met <= bounces)
            point, ray, weight = point[kept], ray[kept], weight[kept]
            met, mirror = met[kept], mirror[kept]
    return found.mean(axis=0), found.std(axis=0, ddof=1) / np.sqrt(parts)


def wall_of_box(point, ray):
    """Where rays meet `BOX`: points, normals, whether the opening, whether plastic."""
    size = np.array([3.0, 4.0, 3.0])
    with np.errstate(divide="ignore"):
        distance = np.where(ray > 0, size - point, -point) / ray
    distance = np.where(ray == 0, np.inf, np.maximum(distance, 0))
    axis, row = distance.argmin(axis=1), np.arange(len(ray))
    far = ray[row, axis] > 0
    normal = np.zeros_like(ray)
    normal[row, axis] = np.where(far, -1, 1)
    opening = (axis == 1) & ~far
    plastic = ((axis == 0) & ~far) | ((axis == 2) & far)
    return point + ray * distance[row, axis][:, None], normal, opening, plastic


def diffuse(normal, random):
    """Directions about normals along the axes, with the density of the cosine."""
    squared, turn = random.random((2, len(normal)))
    flat = np.stack([np.cos(2 * np.pi * turn), np.sin(2 * np.pi * turn)])
    flat = flat * np.sqrt(squared)
    across, along = np.roll(normal, 1, axis=1), np.roll(normal, 2, axis=1)
    lifted = normal * np.sqrt(1 - squared)[:, None]
    return lifted + across * flat[0][:, None] + along * flat[1][:, None]


def test_what_a_highlight_sends_on_is_no_bounce(tmp_path):
    """One bounce is the sensor's own: by way of metal it still sees the sunlit floor.

    Sunlit places are sought from the metal too, which must not count either.
    """
    metal = "void metal m 0 0 5 .5 .4 .3 1 .2"
    (tmp_path / "room.rad").write_text("\n".join([metal, BOX, LIGHT["sun"]]))
    ours = irradiance(
        cl.read_rad(tmp_path / "room.rad"),
        Sensors(POSITION, DIRECTION),
        samples=1 << 16,
        bounces=1,
        seed=1,
        device="cpu",
    )
    truth, spread = seen_by_radiance(tmp_path, "room.rad", bounces=1, highlight=2000)
    error = np.hypot(ours.error, spread)
    assert np.median(error / truth) < 0.02
    assert np.all(np.abs(ours.irradiance - truth) < 4 * error)


@pytest.mark.slow
@pytest.mark.parametrize("name", SHEETS)
def test_views_of_a_window_sum_to_what_rtrace_reads(tmp_path, name):
    """A window of unit radiance sends what the row of its view matrix holds.

    Of metals rtrace takes many samples after a bounce: with few, their highlights
    bring up to 6 % more, with ever more samples ever less.
    """
    (tmp_path / "room.rad").write_text("\n".join([SHEETS[name], BOX]))
    (tmp_path / "window.rad").write_text(WINDOW)
    matrix = cl.view_matrix(
        cl.read_rad(tmp_path / "room.rad"),
        cl.read_window(tmp_path / "window.rad"),
        sensors=Sensors(POSITION, DIRECTION),
        samples=1 << 15,
        bounces=2,
        seed=1,
        device="cpu",
    )
    found = matrix.values.sum(axis=2).T
    own = np.square(matrix.components.sum(axis=3)).sum(axis=0).T ** 0.5
    truth, spread = seen_by_radiance(
        tmp_path,
        "room.rad window.rad",
        bounces=2,
        highlight=highlight(name),
    )
    error = np.hypot(own, spread)
    assert np.median(error / truth) < 0.01
    allowed = 0.005 if name.startswith("smooth") else 0.02
    assert np.all(np.abs(found - truth) < 4 * error + allowed * truth)
    assert abs(found.sum() / truth.sum() - 1) < allowed
