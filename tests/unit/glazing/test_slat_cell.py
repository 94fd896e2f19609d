"""Slats of any profile against ray casting of the same profile.

The rays here start far outside the blind, and slats are found by brute force: none of
the geometry of the package is used but the corners of the profile.
"""

import numpy as np
import pytest

from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane
from clerestory.glazing.slat_cell import SlatCell, SlatGeometry
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

# Width, spacing, rise [mm] and tilt [°]; the first four were wrong by 0.35 to 0.95
PROFILES = [
    (16, 12, 5, 45),
    (16, 12, 3, 60),
    (16, 12, 6, 60),
    (50, 42, 5.4, 75),
    (16, 12, 5, -45),
    (16, 12, -5, 45),
    (80, 72, 10, -80),
    (25, 20, 2, 0),
    (25, 30, 11, 30),
    (50, 42, 0, 90),
    (60, 25, -20, -65),
]


# Dense or strongly curved; with five segments, reflectance was wrong by up to 0.14
CURVED = [(95, 38, 40, -72), (73, 36, 29.7, -34), (82, 68, 12.6, -73)]


def geometry(width, spacing, rise, tilt_deg, segments=12):
    radius = 0.0
    if rise:
        radius = np.sign(rise) * (width**2 / 4 + rise**2) / (2 * abs(rise)) / 1000
    return SlatGeometry(
        width / 1000, spacing / 1000, np.radians(tilt_deg), radius, segments
    )


def nearest(origin, direction, corners):
    """Distance to each ray's first segment, its number and the sine on it."""
    start, along = corners[:, :-1], np.diff(corners, axis=1)
    start, along = start.reshape(-1, 2), along.reshape(-1, 2)
    across = direction[:, None, 0] * along[:, 1] - direction[:, None, 1] * along[:, 0]
    gap = start - origin[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        distance = (gap[..., 0] * along[:, 1] - gap[..., 1] * along[:, 0]) / across
        place = (
            gap[..., 0] * direction[:, None, 1] - gap[..., 1] * direction[:, None, 0]
        )
        place /= across
    met = (distance > 1e-9) & (place >= 0) & (place <= 1)
    distance = np.where(met, distance, np.inf)
    return distance.min(axis=1), distance.argmin(axis=1), along


def cast(slats, direction, reflectance, rays=10_000, bounces=25):
    """Transmitted and reflected shares of parallel rays, by a random walk."""
    rng = np.random.default_rng(3)
    profile = slats.polyline()
    count = int(np.ceil(2 * slats.width / slats.spacing)) + 3
    shift = np.arange(-count, count + 1)[:, None, None] * [0, slats.spacing]
    corners = profile + shift
    left, right = profile[:, 0].min(), profile[:, 0].max()
    way = np.tile(direction / np.linalg.norm(direction), (rays, 1))
    begin = left if direction[0] > 0 else right
    origin = np.stack(
        [np.full(rays, begin), rng.uniform(0, slats.spacing, rays)], axis=1
    )
    origin -= 1e-6 * slats.width * way
    through = back = 0.0
    weight = np.ones(rays)
    for _ in range(bounces):
        distance, segment, along = nearest(origin, way, corners)
        gone = np.isinf(distance)
        forward = gone & (way[:, 0] * direction[0] > 0)
        through += weight[forward].sum()
        back += weight[gone & ~forward].sum()
        kept = ~gone
        if not reflectance or not kept.any():
            break
        tangent = along[segment[kept]]
        tangent /= np.linalg.norm(tangent, axis=1, keepdims=True)
        normal = np.stack([-tangent[:, 1], tangent[:, 0]], axis=1)
        normal *= -np.sign(np.sum(normal * way[kept], axis=1))[:, None]
        origin = origin[kept] + distance[kept, None] * way[kept]
        sine = rng.uniform(-1, 1, kept.sum())[:, None]
        way = sine * tangent + np.sqrt(1 - sine**2) * normal
        origin[:, 1] %= slats.spacing
        weight = reflectance * weight[kept]
    return through / rays, back / rays


@pytest.mark.parametrize("profile", PROFILES)
@pytest.mark.parametrize("angle_deg", [0, 35, -60])
def test_black_slats_pass_what_misses_them(profile, angle_deg):
    slats = geometry(*profile)
    cell = SlatCell.between(slats)
    angle = np.radians(angle_deg)
    for sign, opening, other in ((1, cell.sky, cell.room), (-1, cell.room, cell.sky)):
        direction = np.array([sign * np.cos(angle), np.sin(angle)])
        share = cell.beam(direction[None], opening=opening)[0, other]
        truth, _ = cast(slats, direction, 0.0)
        assert share == pytest.approx(truth, abs=0.015)


@pytest.mark.parametrize("seed", range(6))
def test_random_slats_pass_and_reflect_what_a_random_walk_does(seed):
    """Slats of 60 % reflectance: a walk of 10,000 rays has errors below 0.005.

    Radiosity is constant on a segment: with the 12 segments of the tests above, slats
    that touch differ by up to 0.03, with 40 by less than 0.01.
    """
    rng = np.random.default_rng(seed)
    width = rng.uniform(10, 90)
    spacing = width * rng.uniform(0.5, 1.3)
    rise = rng.choice([-1, 1]) * width * rng.uniform(0, 0.45)
    slats = geometry(width, spacing, rise, rng.uniform(-90, 90), segments=40)
    share = np.full(2, 0.6)
    none = np.zeros(2)
    grey = Pane("grey", np.array([300.0, 2500.0]), Optics(none, none, share, share))
    patches = klems("quarter")
    layer = VenetianBlind(grey, slats, distribution="uniform")
    found = layer.matrices(np.array([550.0]), patches)
    measure = patches.projected_solid_angles()
    for patch in rng.choice(len(measure), 2, replace=False):
        z, y = patches.centres()[patch, [2, 1]]
        for side, sign in (("front", 1), ("back", -1)):
            through, back = cast(slats, np.array([sign * z, y]), 0.6)
            passed = measure @ getattr(found, f"transmission_{side}")[0][:, patch]
            returned = measure @ getattr(found, f"reflection_{side}")[0][:, patch]
            assert passed == pytest.approx(through, abs=0.012)
            assert returned == pytest.approx(back, abs=0.012)


@pytest.mark.parametrize("profile", CURVED)
def test_default_number_of_segments_is_that_of_an_arc(profile):
    """Slats of 70 % reflectance against a walk between arcs of 60 segments."""
    share, none = np.full(2, 0.7), np.zeros(2)
    grey = Pane("grey", np.array([300.0, 2500.0]), Optics(none, none, share, share))
    patches = klems("quarter")
    measure = patches.projected_solid_angles()
    slats = geometry(*profile, segments=None)
    layer = VenetianBlind(grey, slats, distribution="uniform")
    found = layer.matrices(np.array([550.0]), patches)
    z, y = patches.centres()[13, [2, 1]]
    for side, sign in (("front", 1), ("back", -1)):
        way = np.array([sign * z, y])
        through, back = cast(geometry(*profile, segments=60), way, 0.7)
        passed = measure @ getattr(found, f"transmission_{side}")[0][:, 13]
        returned = measure @ getattr(found, f"reflection_{side}")[0][:, 13]
        assert passed == pytest.approx(through, abs=0.02)
        assert returned == pytest.approx(back, abs=0.02)
