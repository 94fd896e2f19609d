"""Glare from sampled directions: closed forms, brute force and full pictures."""

import numpy as np
import pytest
from glare_rooms import FISHEYE
from scipy.sparse.csgraph import connected_components

from analytic_room import analytic_room
from clerestory.directions import unit
from clerestory.errors import InputError
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.detection_criteria import SourceRules, Zone
from clerestory.glare.dgp import dgp
from clerestory.glare.direction_groups import DirectionGroups
from clerestory.glare.eye_directions import (
    SUN_SOLID_ANGLE,
    SunDisc,
    directions_at,
    seen_by,
)
from clerestory.glare.point_glare import point_glare, views_around
from clerestory.glare.position_index import position_index
from clerestory.glare.source_table import GlareSources
from clerestory.glare.sphere_refinement import (
    Refinement,
    sample_sphere,
    sampling_error,
)
from clerestory.glare.sphere_samples import regular_samples
from clerestory.scene.view import View

AHEAD = np.array([0.0, 1.0, 0.0])


def disc(samples, centre, angle):
    """Which samples lie within an angle of a direction."""
    return samples.direction @ unit(np.asarray(centre, float)) > np.cos(angle)


def caps(samples, *parts, around=100.0):
    """Luminance of discs (centre, angle, luminance) before a ground."""
    level = np.full((samples.count, 1), around)
    for centre, angle, value in parts:
        level[disc(samples, centre, angle)] = value
    return level


def one(dataset, name):
    return float(dataset[name].values.ravel()[0])


# --- closed forms -------------------------------------------------------------------


def test_sky_gives_every_direction_half_of_its_horizontal_illuminance():
    """A uniform upper hemisphere: Ev = πL/2 on any vertical plane."""
    samples = regular_samples(6)
    sky = np.where(samples.direction[:, 2:] > 0, [1000.0, 400.0], 0.0)
    found = point_glare(samples, sky, views_around(8, first=0.3))
    expected = np.tile(np.pi / 2 * np.array([1000.0, 400.0]), (8, 1))
    np.testing.assert_allclose(found.illuminance, expected, rtol=0.01)
    np.testing.assert_allclose(
        found.azimuth, np.degrees(0.3) + 45 * np.arange(8), atol=1e-9
    )


def test_a_night_has_empty_indices():
    samples = regular_samples(3)
    found = point_glare(samples, np.zeros((samples.count, 0)), [FISHEYE])
    assert found.dgp.shape == found.illuminance.shape == (1, 0)


def test_a_bright_cap_ahead_is_one_source_of_its_size():
    """A cap of half angle α ahead has E = πL sin²α and ω = 2π(1 − cos α), at P = 1."""
    samples = regular_samples(8)
    angle, level = 0.25, 8000.0
    found = point_glare(samples, caps(samples, (AHEAD, angle, level)), [FISHEYE])
    omega, direct = 2 * np.pi * (1 - np.cos(angle)), np.pi * level * np.sin(angle) ** 2
    assert one(found, "source_count") == 1
    assert one(found, "source_solid_angle") == pytest.approx(omega, rel=0.01)
    assert one(found, "direct_illuminance") == pytest.approx(direct, rel=0.01)
    illuminance = direct + np.pi * 100 * np.cos(angle) ** 2
    cap = GlareSources.of(luminance=[level], solid_angle=[omega], position_index=[1])
    expected = dgp(cap, illuminance=illuminance)
    assert one(found, "dgp") == pytest.approx(expected, abs=2e-3)
    background = 100 * np.cos(angle) ** 2
    ugr = 8 * np.log10(0.25 / background * level**2 * omega)
    assert one(found, "ugr") == pytest.approx(ugr, abs=0.1)


@pytest.mark.parametrize("share", [1.0, 0.4])
def test_the_suns_disc_has_its_own_illuminance_and_dgp(share):
    samples = regular_samples(5)
    towards = unit(np.array([[0.3, 1.0, 0.4]]))
    sun = SunDisc(towards, np.array([2e8]), np.array([share * SUN_SOLID_ANGLE]))
    found = point_glare(samples, caps(samples), [FISHEYE], sun=sun)
    omega, cosine = share * SUN_SOLID_ANGLE, towards[0, 1]
    weight = samples.solid_angle @ np.maximum(samples.direction[:, 1], 0)
    illuminance = 2e8 * omega * cosine + 100 * weight
    assert one(found, "illuminance") == pytest.approx(illuminance, rel=1e-9)
    across = towards[0, 2] / np.sqrt(1 - cosine**2)
    sigma, tau = np.arccos([cosine]), np.arccos([across])
    index = position_index(sigma, tau, np.array([False]))
    alone = GlareSources.of(luminance=[2e8], solid_angle=[omega], position_index=index)
    assert one(found, "source_count") == 1
    expected = dgp(alone, illuminance=illuminance)
    assert one(found, "dgp") == pytest.approx(expected, abs=1e-9)


def test_a_sun_behind_or_hidden_has_no_effect():
    samples = regular_samples(5)
    level = np.repeat(caps(samples, (AHEAD, 0.3, 6000.0)), 3, axis=1)
    towards = np.stack([-AHEAD, AHEAD, AHEAD])
    size = np.array([SUN_SOLID_ANGLE, 0, SUN_SOLID_ANGLE])
    sun = SunDisc(towards, np.array([1e9, 1e9, 0]), size)
    found, plain = (
        point_glare(samples, level, [FISHEYE], sun=s).drop_vars(["azimuth"])
        for s in (sun, None)
    )
    assert found.equals(plain)


def test_dgp_of_many_steps_at_once_is_that_of_single_steps():
    """Steps in several blocks, with and without sun, small sources, and in the dark."""
    samples, rules = regular_samples(5), SourceRules(smallest=0.01)
    bright = caps(
        samples, (AHEAD, 0.3, 6000.0), (unit(np.array([1.0, 1, 1])), 0.1, 9e3)
    )
    level = bright * np.linspace(0, 2, 600)
    towards = unit(np.array([[0.3, 1.0, 0.4]]).repeat(600, axis=0))
    size = np.where(np.arange(600) % 3, SUN_SOLID_ANGLE, 0)
    sun = SunDisc(towards, np.full(600, 1e8), size)
    rest = {"sun": sun, "rules": rules}
    at_once = point_glare(
        samples, level, views_around(4), quantities=["dgp", "illuminance"], **rest
    )
    every = point_glare(samples, level, views_around(4), **rest)
    for name in ("dgp", "illuminance"):
        np.testing.assert_allclose(at_once[name], every[name], rtol=1e-6)
    assert at_once["dgp"].max() > at_once["dgp"].min() + 0.1


@pytest.mark.parametrize(("level", "count"), [(3e4, 1), (1e9, 2)])
def test_a_sun_in_a_window_is_a_source_of_its_own_only_if_it_is_a_peak(level, count):
    samples = regular_samples(6)
    window = caps(samples, (AHEAD, 0.4, 5000.0))
    sun = SunDisc(AHEAD[None], np.array([level]), np.array([SUN_SOLID_ANGLE]))
    assert (
        one(point_glare(samples, window, [FISHEYE], sun=sun), "source_count") == count
    )
    rules = SourceRules(peak_luminance=None)
    found = point_glare(samples, window, [FISHEYE], sun=sun, rules=rules)
    assert one(found, "source_count") == 1


# --- groups of directions -----------------------------------------------------------


@pytest.mark.parametrize(("gap", "count"), [(0.08, 1), (0.13, 2)])
def test_sources_are_merged_within_half_the_merging_angle(gap, count):
    samples = regular_samples(8)
    turn = 0.2 + gap
    other = [np.sin(turn), np.cos(turn), 0]
    two = caps(samples, (AHEAD, 0.1, 5000.0), (other, 0.1, 4000.0))
    assert one(point_glare(samples, two, [FISHEYE]), "source_count") == count
    wide = SourceRules(merge_angle=0.4)
    assert one(point_glare(samples, two, [FISHEYE], rules=wide), "source_count") == 1


def test_groups_are_those_of_single_linkage():
    """Against connected components of the full matrix of angles, step by step."""
    random = np.random.default_rng(2)
    direction = unit(random.normal(size=(1000, 3)) + np.array([0, 2.0, 0]))
    close = np.triu(direction @ direction.T > np.cos(0.03), 1).any(axis=0)
    direction = direction[~close]
    count, gap, size = len(direction), 0.1, 1e-9
    groups = DirectionGroups(direction, np.full(count, size), gap)
    bright = random.random((count, 40)) < np.linspace(0.02, 0.5, 40)
    labels = groups.components(bright, np.zeros(bright.shape, bool))
    for step in range(40):
        some = np.flatnonzero(bright[:, step])
        angle = np.arccos(np.clip(direction[some] @ direction[some].T, -1, 1))
        count, _ = connected_components(angle <= gap + np.sqrt(size))
        assert len(set(labels[groups.block[some], step])) == count


def test_peaks_close_together_are_one_source():
    samples = regular_samples(8)
    places = [[np.sin(t), np.cos(t), 0] for t in (0.0, 0.08, 0.3)]
    window = caps(samples, (AHEAD, 0.5, 5000.0), *((p, 0.02, 1e6) for p in places))
    assert one(point_glare(samples, window, [FISHEYE]), "source_count") == 3


# --- the same rules as pictures -----------------------------------------------------


TILTED = View(
    "angular",
    direction=np.array([0.5, 1.0, -0.2]),
    up=np.array([0.1, 0.0, 1.0]),
    horizontal=180,
    vertical=180,
)


@pytest.mark.parametrize("view", [FISHEYE, TILTED], ids=["level", "tilted"])
@pytest.mark.parametrize(
    "rules",
    [
        SourceRules(),
        SourceRules(threshold=5.0, threshold_kind="times_mean"),
        SourceRules(field_of_view="binocular"),
        SourceRules(smallest=0.05, peak_luminance=2e4),
    ],
    ids=["fixed", "times_mean", "binocular", "smallest"],
)
def test_every_index_is_that_of_a_picture(view, rules):
    """Three sources and a peak; the indices from 65,536 directions and 160,000 pixels.

    Veiling luminances are left out: they grow beyond limits at the line of sight.
    """
    places = [([-0.7, 1.0, 0.3], 0.35, 4e3), ([0.9, 1.0, 0.1], 0.2, 9e3)]
    places += [([0.1, 1.0, -0.9], 0.15, 3e3), ([0.8, 1.0, 0.2], 0.05, 6e4)]

    def luminance(direction):
        level = np.full(len(direction), 150.0)
        for centre, angle, value in places:
            near = direction @ unit(np.array(centre)) > np.cos(angle)
            level[near] = value
        return level

    samples = regular_samples(8)
    rays = view.rays(400, 400)
    pixels = np.zeros((1, 400, 400))
    pixels[0][rays.valid] = luminance(rays.direction[rays.valid])
    picture = annual_glare(pixels, view, rules=rules)
    found = point_glare(
        samples, luminance(samples.direction)[:, None], [view], rules=rules
    )
    assert set(found.data_vars) == set(picture.data_vars)
    for name in set(found.data_vars) - {"veiling_luminance", "cie_veiling_luminance"}:
        expected = one(picture, name)
        tolerance = {"dgp": 0.003, "vcp": 1.0}.get(name, 0.02 * abs(expected))
        assert one(found, name) == pytest.approx(expected, abs=tolerance), name


def test_places_in_a_fisheye_and_directions_are_inverse():
    samples = regular_samples(4)
    eye = seen_by(TILTED, samples.direction)
    back = directions_at(TILTED, eye.place)
    np.testing.assert_allclose(back, samples.direction, atol=1e-9)


def differences_from_pictures(room, views, size, **how):
    """DGP of adaptive samples less that of pictures, in all views and steps."""
    steps = len(room.sun)
    samples = sample_sphere(room.of_samples, views, **how)
    light = room.luminance(samples.direction)
    found = point_glare(samples, light, views, sun=room.disc()).dgp.values
    for number, view in enumerate(views):
        rays = view.rays(size, size)

        def pictures(rays=rays):
            for step in range(steps):
                part = room.at(slice(step, step + 1))
                pixels = np.zeros(rays.valid.shape)
                pixels[rays.valid] = part.picture(rays.direction[rays.valid])[:, 0]
                yield pixels

        found[number] -= annual_glare(pictures(), view).dgp.values
    return found[[room.is_whole(view) for view in views]]


@pytest.mark.parametrize("kind", ["window", "slats", "sky"])
def test_dgp_of_adaptive_samples_is_that_of_pictures(kind):
    """Mean error at most .005, 95 % within .02."""
    room = analytic_room(kind, steps=6)
    error = np.abs(differences_from_pictures(room, views_around(3), 300))
    assert error.mean() < 0.005
    assert np.quantile(error, 0.95) < 0.02


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["window", "slats", "sky"])
def test_dgp_of_eight_views_is_that_of_full_pictures(kind):
    """2000 directions, 800² pixels, 24 steps: .005, .02, and no class is skipped."""
    room, few = analytic_room(kind), Refinement(most=2000, tolerance=0.001)
    error = differences_from_pictures(room, views_around(8), 800, refinement=few)
    assert np.abs(error).mean() < 0.005
    assert np.quantile(np.abs(error), 0.95) < 0.02
    assert np.abs(error).max() < 0.05


# --- refinement ---------------------------------------------------------------------


def test_cells_are_asked_for_in_a_few_batches_and_each_once():
    room, views = analytic_room("slats", steps=8), views_around(8)
    asked = []

    def luminance(samples):
        asked.append(samples.direction)
        return room.of_samples(samples)

    samples = sample_sphere(luminance, views, refinement=Refinement(most=3000))
    assert len(asked) <= 6
    assert samples.count <= 3000
    every = [tuple(d) for d in np.concatenate(asked)]
    assert len(every) == len(set(every))
    assert {tuple(d) for d in samples.direction} <= set(every)
    assert samples.solid_angle.sum() == pytest.approx(4 * np.pi)


def test_every_direction_is_in_its_own_cell():
    room, views = analytic_room("window", steps=3), views_around(4)
    samples = sample_sphere(room.of_samples, views, seed=4)
    assert len(set(samples.level.tolist())) > 1
    np.testing.assert_array_equal(
        samples.containing(samples.direction), np.arange(samples.count)
    )


def test_smooth_light_is_not_refined():
    samples = sample_sphere(lambda s: 500 + 100 * s.direction[:, :1], [FISHEYE])
    assert set(samples.level.tolist()) == {5}


@pytest.mark.parametrize("kind", ["window", "slats", "sky"])
def test_standard_error_is_the_scatter_over_seeds(kind):
    """Root mean square over views and steps, 12 seeds."""
    room, views = analytic_room(kind, steps=8), views_around(3)
    values, errors = [], []
    for seed in range(12):
        samples = sample_sphere(room.of_samples, views, seed=seed)
        light = room.luminance(samples.direction)
        found = point_glare(samples, light, views, quantities=["dgp"])
        values.append(found.dgp.values)
        errors.append(sampling_error(samples, light, views))
    scatter = np.sqrt(np.var(values, axis=0, ddof=1).mean())
    assert 0.5 < np.sqrt(np.square(errors).mean()) / scatter < 2


def test_a_small_lamp_is_found_where_details_are_named():
    lamp = unit(np.array([0.3, 1.0, 0.5]))

    def luminance(samples):
        shines = samples.direction @ lamp > np.cos(0.012)
        return np.where(shines, 40_000.0, 50.0)[:, None]

    samples = sample_sphere(luminance, [FISHEYE], details=lamp[None])
    found = point_glare(samples, luminance(samples), [FISHEYE])
    omega = 2 * np.pi * (1 - np.cos(0.012))
    assert one(found, "source_solid_angle") == pytest.approx(omega, rel=0.25)


def test_darkness_has_no_sources():
    samples = regular_samples(3)
    found = point_glare(samples, np.zeros((samples.count, 2)), views_around(2))
    assert found.source_count.values.tolist() == [[0, 0], [0, 0]]
    assert found.dgp.values == pytest.approx(0.159)


# --- bad input ----------------------------------------------------------------------


def test_bad_input_is_named():
    samples = regular_samples(2)
    light = np.ones((16, 3))
    with pytest.raises(InputError, match=r"has shape \(15, 3\); \(16, 3\) expected"):
        point_glare(samples, light[1:], [FISHEYE])
    with pytest.raises(InputError, match="2 times for 3 time steps"):
        point_glare(samples, light, [FISHEYE], times=np.arange(2))
    with pytest.raises(InputError, match="no views"):
        point_glare(samples, light, [])
    task = SourceRules(task=Zone(1, 1, 0.1))
    with pytest.raises(InputError, match="a picture expected"):
        point_glare(samples, light, [FISHEYE], rules=task)
    with pytest.raises(InputError, match="glare quantity is 'glare'"):
        point_glare(samples, light, [FISHEYE], quantities=["glare"])
    with pytest.raises(InputError, match="negative or not finite"):
        point_glare(samples, -light, [FISHEYE])
    with pytest.raises(InputError, match="luminance of the sun is -1"):
        SunDisc(AHEAD[None], np.array([-1.0]), np.array([1e-5]))
    with pytest.raises(InputError, match="largest number of directions is 100"):
        Refinement(most=100)
