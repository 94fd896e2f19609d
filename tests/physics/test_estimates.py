"""Standard errors equal the scatter, results are reproducible, densities correct."""

import numpy as np
import pytest
from physics_scenes import box, grey, quad, window
from scipy import stats

import clerestory as cl
from clerestory.engine import device as devices

# The engine's modules, Mitsuba and Dr.Jit exist once a device was started
controller = devices.load("cpu")

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials, work_units
from clerestory.engine.patches import PatchTable, SkyTable
from clerestory.engine.sampler import points
from clerestory.engine.windows import window_shapes
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.scene.model import Glass, Scene
from clerestory.scene.sensors import Sensors

SENSORS = Sensors(np.array([[2, 1, 1.0], [1, 4, 1]]), np.tile([0, 0, 1.0], (2, 1)))


def test_standard_errors_equal_the_scatter_over_seeds(device):
    """Over 60 seeds, deviations from a long run follow the errors that are stated."""
    scene, south = box(4, 5, 3, 0.6)
    options = {"sensors": SENSORS, "device": device}
    long = cl.view_matrix(scene, south, samples=1 << 19, seed=1000, **options)
    truth = long.values[0].sum(axis=1)
    scores = []
    for seed in range(60):
        short = cl.view_matrix(scene, south, samples=1024, seed=seed, **options)
        error = np.sqrt(np.square(short.components[:, 0].sum(axis=2)).sum(axis=0))
        scores.append((short.values[0].sum(axis=1) - truth) / error)
    # Batches number 16: deviations over their errors follow Student's t with 15
    spread = np.square(scores).mean()
    assert 0.6 < spread / stats.t(15).var() < 1.6
    assert abs(np.mean(scores)) < 4 * np.sqrt(stats.t(15).var() / np.size(scores))


def test_the_error_aimed_at_is_reached(device):
    """Every sensor's irradiance under a uniform window is as good as asked for."""
    scene, south = box(4, 5, 3, 0.6)
    matrix = cl.view_matrix(
        scene, south, sensors=SENSORS, relative_error=0.003, device=device
    )
    error = np.sqrt(np.square(matrix.components[:, 0].sum(axis=2)).sum(axis=0))
    assert np.all(error <= 0.003 * matrix.values[0].sum(axis=1) * (1 + 1e-6))


def test_twice_the_same_seed_gives_the_same_bits(device):
    """Sums are exact integers: no order of additions changes them."""
    scene, south = box(4, 5, 3, 0.6)
    one, two = (
        cl.view_matrix(
            scene, south, sensors=SENSORS, samples=5000, seed=3, device=device
        )
        for _ in range(2)
    )
    assert np.array_equal(one.values, two.values)
    assert np.array_equal(one.components, two.components)


def test_results_do_not_depend_on_the_size_of_launches(device, monkeypatch):
    """Rows and stretches are pure units: however they are cut, the sum is the same."""
    scene, south = box(4, 5, 3, 0.6)
    options = {"sensors": SENSORS, "samples": 16 * 600, "seed": 3, "device": device}
    whole = cl.view_matrix(scene, south, **options)
    monkeypatch.setattr(work_units, "_PATHS", 16 * 256)
    monkeypatch.setattr(controller, "_LONGEST_RANGE", 256)
    cut = cl.view_matrix(scene, south, **options)
    assert np.array_equal(whole.values, cut.values)


def test_other_seeds_give_other_estimates(device):
    """A seed is no decoration."""
    scene, south = box(4, 5, 3, 0.6)
    one, two = (
        cl.view_matrix(
            scene, south, sensors=SENSORS, samples=256, seed=s, device=device
        )
        for s in (1, 2)
    )
    assert not np.array_equal(one.values, two.values)


def test_far_from_the_origin_nothing_changes(device):
    """A room ten kilometres away reads what it reads at the origin."""
    far = np.array([8000.0, -6000.0, 120.0])
    results = []
    for shift in (np.zeros(3), far):
        scene, south = box(4, 5, 3, 0.6)
        moved = Scene(
            scene.materials, tuple(quad(*(s.vertices + shift)) for s in scene.surfaces)
        )
        pane = window(quad(*(south.polygons[0].vertices + shift)))
        sensors = Sensors(SENSORS.position + shift, SENSORS.direction)
        results.append(
            cl.view_matrix(moved, pane, sensors=sensors, samples=1 << 14, device=device)
        )
    assert results[1].values.sum() == pytest.approx(results[0].values.sum(), rel=1e-3)


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
def test_kernels_number_klems_patches_as_numpy_does(device, basis):
    """Both look the same tables up."""
    partition = klems(basis)
    directions = stats.uniform_direction(3, seed=1).rvs(20000)
    directions[:, 2] = np.abs(directions[:, 2])
    found = PatchTable.of(partition).find(mi.Vector3f(directions.T.astype("f4")))
    differ = found.numpy() != partition.find(directions)
    assert np.mean(differ) < 1e-3  # on the very edges, float32 may fall to either side


@pytest.mark.parametrize("subdivision", [1, 2, 4, 6])
def test_kernels_number_sky_patches_as_numpy_does(device, subdivision):
    """Both look the same tables up, below the horizon too."""
    partition = reinhart(subdivision)
    directions = stats.uniform_direction(3, seed=2).rvs(20000)
    found = SkyTable.of(partition).find(mi.Vector3f(directions.T.astype("f4")))
    differ = found.numpy() != partition.find(directions)
    assert np.mean(differ) < 1e-3


def test_kernels_sample_within_their_patch(device):
    """Directions drawn in a patch are found in it, and follow the cosine."""
    partition = klems("full")
    table = PatchTable.of(partition)
    patch = np.repeat(np.arange(145), 400).astype(np.uint32)
    u = np.random.default_rng(1).random((len(patch), 2), dtype="f4")
    drawn = (
        table.sample(mi.UInt32(patch), mi.Float(u[:, 0]), mi.Float(u[:, 1])).numpy().T
    )
    assert np.mean(partition.find(drawn.astype(float)) != patch) < 2e-3


def test_windows_are_sampled_evenly_by_solid_angle(device):
    """Weighted points on a near rectangle reproduce its solid angle and its moments."""
    pane = window(quad((0, 0, 0), (0, 0, 1.5), (2, 0, 1.5), (2, 0, 0)))
    table, _ = window_shapes([pane], np.zeros(3))
    sequence = points(0, 1 << 14)
    u = dr.brev(sequence.table)
    n = sequence.count
    take = [dr.gather(mi.UInt32, u, dr.arange(mi.UInt32, n) + k * n) for k in (0, 1)]
    u, v = (mi.Float(t >> 8) / (1 << 24) for t in take)
    origin = mi.Point3f(0.3, 0.4, 0.2)
    point, _, _, _, spherical = table.sample_direction(origin, u, v)
    # Solid angle of a rectangle from a point: four corner terms of the arctangent form
    corners = [(0 - 0.3, 0 - 0.2), (2 - 0.3, 1.5 - 0.2)]
    solid = 0.0
    for sx, x in zip((-1, 1), (corners[0][0], corners[1][0]), strict=True):
        for sz, z in zip((-1, 1), (corners[0][1], corners[1][1]), strict=True):
            solid += sx * sz * np.arctan(x * z / (0.4 * np.sqrt(x**2 + z**2 + 0.16)))
    assert (1 / spherical.numpy()).mean() == pytest.approx(solid, rel=1e-4)

    # A function integrated with these points and by a fine grid over the area
    p = point.numpy().T
    assert p[:, 0].min() >= -1e-6
    assert p[:, 0].max() <= 2 + 1e-6
    assert abs(p[:, 1]).max() < 1e-5
    integral = np.mean(p[:, 0] ** 2 * p[:, 2] / spherical.numpy())
    x, z = (np.arange(2000) + 0.5) / 1000, (np.arange(1500) + 0.5) / 1000
    gx, gz = np.meshgrid(x, z)
    r2 = (gx - 0.3) ** 2 + (gz - 0.2) ** 2 + 0.16
    truth = np.sum(gx**2 * gz * 0.4 / r2**1.5) * 1e-6
    assert integral == pytest.approx(truth, rel=2e-3)


PLASTICS = {
    "matt": {},
    "shiny": {"specularity": 0.3, "roughness": 0.15},
    "metallic sheen": {"specularity": 0.9, "roughness": 0.3},
}


@pytest.mark.parametrize("name", PLASTICS)
@pytest.mark.parametrize("tilt_deg", [10, 60, 150])
def test_plastic_samples_its_own_density(device, name, tilt_deg):
    """Mitsuba's chi² test of the plugin, from the front and from the back."""
    from mitsuba import chi2

    materials.register()
    bsdf = materials.load(grey(0.4, **PLASTICS[name]))
    sample, pdf = _adapter(bsdf, np.radians(tilt_deg))
    test = chi2.ChiSquareTest(
        domain=chi2.SphericalDomain(),
        sample_func=sample,
        pdf_func=pdf,
        sample_dim=3,
        sample_count=200_000,
        res=51,
    )
    assert test.run(0.01, 1), test.messages


def _adapter(bsdf, tilt):

    def interaction(n):
        si = dr.zeros(mi.SurfaceInteraction3f, n)
        si.wi = mi.Vector3f(float(np.sin(tilt)), 0, float(np.cos(tilt)))
        return si

    def sample(u):
        n = dr.width(u)
        bs, weight = bsdf.sample(
            mi.BSDFContext(), interaction(n), u.x, mi.Point2f(u.y, u.z)
        )
        alive = dr.any(weight > 0)
        return bs.wo, dr.select(alive, mi.Float(1), mi.Float(0))

    def pdf(wo):
        return bsdf.pdf(mi.BSDFContext(), interaction(dr.width(wo)), wo)

    return sample, pdf


@pytest.mark.parametrize("name", PLASTICS)
def test_plastic_obeys_reciprocity_and_energy(device, name):
    """f(a, b) = f(b, a); what is reflected is no more than what arrives."""
    materials.register()
    bsdf = materials.load(grey(0.4, **PLASTICS[name]))
    rng = np.random.default_rng(3)
    n = 5000
    a, b = (stats.uniform_direction(3, seed=rng).rvs(n) for _ in range(2))
    a[:, 2], b[:, 2] = np.abs(a[:, 2]), np.abs(b[:, 2])

    def value(i, o):
        si = dr.zeros(mi.SurfaceInteraction3f, n)
        si.wi = mi.Vector3f(i.T.astype("f4"))
        f = bsdf.eval(mi.BSDFContext(), si, mi.Vector3f(o.T.astype("f4")))
        return f.numpy()[0] / o[:, 2]

    assert value(a, b) == pytest.approx(value(b, a), rel=2e-3, abs=1e-5)

    # Albedo by sampling, for each of n incident directions many times over
    u = mi.Point2f(rng.random((2, n), dtype="f4"))
    for cosine in (0.95, 0.5, 0.1):
        si = dr.zeros(mi.SurfaceInteraction3f, n)
        si.wi = mi.Vector3f(float(np.sqrt(1 - cosine**2)), 0, cosine)
        _, weight = bsdf.sample(
            mi.BSDFContext(), si, mi.Float(rng.random(n, dtype="f4")), u
        )
        albedo = weight.numpy()[0]
        assert albedo.mean() < 1 + 4 * albedo.std() / np.sqrt(n)


def test_glass_neither_makes_nor_hides_light(device):
    """Transmittance and reflectance sum to one for a pane that absorbs nothing."""
    materials.register()
    bsdf = materials.load(Glass("pane", np.ones(3)))
    n = 64
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    cosine = np.linspace(0.02, 1, n)
    si.wi = mi.Vector3f(np.sqrt(1 - cosine**2).astype("f4"), 0, cosine.astype("f4"))
    through = bsdf.eval_null_transmission(si).numpy()[0]
    draws = []
    for lobe in (0.0, 0.999999):
        bs, weight = bsdf.sample(mi.BSDFContext(), si, lobe, mi.Point2f(0.5, 0.5))
        draws.append(weight.numpy()[0] * bs.pdf.numpy())
    assert draws[0] == pytest.approx(through, abs=1e-6)
    assert draws[0] + draws[1] == pytest.approx(1, abs=1e-5)
