"""The interpolant as a scattering function, against the layers that were measured."""

import numpy as np
import pytest

from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.errors import InputError
from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.cross_validation import beam_direction
from clerestory.gonio.fitted_measurement import (
    Fitted,
    conserve_energy,
    export_bsdf,
    fit_measurement,
    measured_bsdf,
)
from clerestory.gonio.interpolant import Interpolant
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.network_assembly import connect
from clerestory.gonio.raster import Raster
from clerestory.gonio.tree_export import to_tree
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.shirley_chiu import disc_from_square
from clerestory.phases.fingerprint import fingerprint
from goniometer import Goniophotometer, film, pane, rings

FRONT = np.array([1.0, 1.0, -1.0])  # light from the sky
CELL = np.sqrt(np.pi) / 16  # width of a cell of a tree of 2^4 along each axis


def hemisphere(count=4000):
    """Points of equal projected solid angle, π in all."""
    k = np.arange(count) + 0.5
    r, phi = np.sqrt(k / count), np.pi * (1 + 5**0.5) * k
    return np.stack([r * np.cos(phi), r * np.sin(phi), np.sqrt(1 - r * r)], axis=-1)


def between(seed=3, count=12, most_deg=70.0):
    """Incident directions that were not measured."""
    rng = np.random.default_rng(seed)
    theta = np.degrees(
        np.arcsin(np.sqrt(rng.random(count)) * np.sin(np.radians(most_deg)))
    )
    return from_degrees(theta, rng.uniform(0, 360, count))


def test_flux_between_scans_is_that_of_the_layer(pane_fit):
    directions = between()
    share = pane_fit.interpolant.hemispherical(directions * FRONT)
    truth = [pane(d).total for d in directions]
    assert share == pytest.approx(truth, rel=0.02)


def test_beams_between_scans_are_those_of_the_layer(pane_fit):
    for direction in between():
        found = beam_direction(pane_fit.interpolant.lobes(direction * FRONT))
        truth = beam_direction(pane(direction))
        assert angle_between(found, truth) < np.radians(2)


def test_an_isotropic_layer_looks_alike_from_every_azimuth(pane_fit):
    turn = np.radians(77.0)
    matrix = np.array(
        [[np.cos(turn), -np.sin(turn), 0], [np.sin(turn), np.cos(turn), 0], [0, 0, 1]]
    )
    source, exits = from_degrees(35.0, 20.0) * FRONT, between(seed=5)
    one = pane_fit.interpolant.evaluate(np.broadcast_to(source, exits.shape), exits)
    other = pane_fit.interpolant.evaluate(
        np.broadcast_to(matrix @ source, exits.shape), exits @ matrix.T
    )
    assert other == pytest.approx(one, rel=1e-6)


def test_a_mirrored_layer_is_its_mirror_image(film_fit):
    source, exits = from_degrees(35.0, 20.0) * FRONT, between(seed=5)
    mirror = np.array([-1.0, 1, 1])
    one = film_fit.interpolant.evaluate(np.broadcast_to(source, exits.shape), exits)
    other = film_fit.interpolant.evaluate(
        np.broadcast_to(source * mirror, exits.shape), exits * mirror
    )
    assert other == pytest.approx(one, rel=1e-9)


def test_samples_follow_the_distribution(pane_fit):
    """Mean of f·cosθ / density is the share scattered in all."""
    part = pane_fit.interpolant
    source = from_degrees(40.0, 10.0) * FRONT
    u = np.random.default_rng(8).random((4000, 2))
    sources = np.broadcast_to(source, (4000, 3))
    leaving, density = part.sample(sources, u)
    ratio = part.evaluate(sources, leaving) * leaving[:, 2] / density
    error = ratio.std() / np.sqrt(len(ratio))
    assert error < 0.01
    assert abs(ratio.mean() - part.hemispherical(source)) < 4 * error + 2e-3


def test_cells_of_the_raster_hold_all_light_of_narrow_and_wide_lobes():
    for radius in (0.004, 0.03, 0.2, 1.0):
        for theta in (0.0, 50.0, 87.0):
            lobe = Lobes(
                from_degrees(np.array([theta]), np.array([10.0])),
                np.array([radius]),
                np.array([0.3]),
            )
            cells = Raster.of(6).cells(lobe)
            assert cells.sum() * np.pi / len(cells) == pytest.approx(0.3)
            assert cells.min() >= 0


def test_a_raster_of_a_wide_lobe_is_the_lobe():
    lobe = Lobes(np.array([[0, 0.6, 0.8]]), np.array([0.3]), np.array([0.3]))
    raster = Raster.of(6)
    a = (np.arange(64) + 0.5) / 64
    x, y = disc_from_square(
        *(part.ravel() for part in np.meshgrid(a, a, indexing="ij"))
    )
    points = np.stack([x, y, np.sqrt(1 - x * x - y * y)], axis=-1)
    change = np.abs(raster.cells(lobe) - lobe.evaluate(points)).mean() * np.pi
    assert change < 0.03 * 0.3


def test_patches_receive_the_light_of_the_layer(pane_fit):
    part = pane_fit.interpolant
    basis = klems("quarter")
    matrix = ScatteringMatrix(part.average(basis, basis), basis, basis)
    truth = [pane(c).total for c in basis.centres()]
    share = matrix.direct_hemispherical()
    inner = slice(0, int(basis.count[:-1].sum()))
    assert share[inner] == pytest.approx(truth[inner], rel=0.03)
    # Light goes on into the patch of the same number
    assert np.argmax(matrix.values[:, 5]) == 5


@pytest.mark.parametrize("name", ["pane", "film"])
def test_trees_scatter_what_the_interpolant_scatters(name, request):
    part = request.getfixturevalue(f"{name}_fit").interpolant
    tree = to_tree(part, halvings=4)
    assert tree.rank == (3 if name == "pane" else 4)
    source = between(count=6, most_deg=50.0) * FRONT
    assert tree.hemispherical(source) == pytest.approx(
        part.hemispherical(source), rel=0.03
    )
    # From the middle of incident cells light leaves as it does there, but for the size
    # of cells, and to the same place on the whole
    layer = {"pane": pane, "film": film}[name]
    exits = hemisphere()
    for a, b in ((0.53125, 0.53125), (0.59375, 0.34375), (0.28125, 0.46875)):
        x, y = disc_from_square(np.array(a), np.array(b))
        incident = np.array([-x, -y, np.sqrt(1 - x * x - y * y)])
        pairs = np.broadcast_to(incident * FRONT, exits.shape)
        truth, found = layer(incident), tree.evaluate(pairs, exits)
        blurred = Lobes(truth.centre, np.hypot(truth.radius, CELL), truth.flux)
        change = np.abs(found - blurred.evaluate(exits)).mean()
        assert change * np.pi / 2 < 0.2 * truth.total
        middle = [
            values @ exits / values.sum() for values in (found, truth.evaluate(exits))
        ]
        assert middle[0] == pytest.approx(middle[1], abs=0.05)


def test_a_tree_of_a_mirrored_layer_is_mirrored(film_fit):
    tree = to_tree(film_fit.interpolant, halvings=3)
    source, exits = between(seed=1, count=40) * FRONT, between(seed=2, count=40)
    mirror = np.array([-1.0, 1, 1])
    assert np.array_equal(
        tree.evaluate(source, exits), tree.evaluate(source * mirror, exits * mirror)
    )


def test_a_fit_is_a_bsdf(pane_fit):
    bsdf = measured_bsdf([pane_fit])
    source = from_degrees(30.0, 0.0) * FRONT
    to_room = from_degrees(30.0, 180.0)
    assert bsdf.evaluate(source, to_room) > 1
    assert bsdf.evaluate(source, to_room * FRONT) == 0  # reflection is not known
    back = bsdf.evaluate(to_room, source)
    assert back == pytest.approx(bsdf.evaluate(source, to_room), rel=1e-9)


def test_the_fingerprint_of_a_fit_does_not_depend_on_what_it_was_used_for(pane_fit):
    """Matrices that were traced with it are found again."""
    part = pane_fit.interpolant
    again = Interpolant(part.network, part.symmetry)
    before = fingerprint(measured_bsdf([Fitted(again, "transmission_front")]))
    again.hemispherical(between() * FRONT)
    assert again.tabulated().depth == 6
    after = fingerprint(measured_bsdf([Fitted(again, "transmission_front")]))
    assert after == before


def test_exported_matrices_hold_the_functions_of_the_fits(pane_fit):
    bsdf = export_bsdf([pane_fit], "quarter")
    assert set(bsdf.functions) == {("visible", "transmission_front")}
    assert bsdf.diffuse("transmission_front") == pytest.approx(0.8, abs=0.05)


def test_trees_of_two_ranks_do_not_fit_one_layer(pane_fit, film_fit):
    other = Fitted(film_fit.interpolant, "reflection_front")
    with pytest.raises(InputError, match="some anisotropic"):
        export_bsdf([pane_fit, other], "tree", halvings=2)
    with pytest.raises(InputError, match="twice"):
        export_bsdf([pane_fit, pane_fit])


def test_a_layer_that_emits_more_than_it_receives_is_scaled_down():
    lobe = Lobes(np.array([[0, 0, 1.0]]), np.array([0.2]), np.array([0.7]))
    sources = from_degrees(np.array([0.0, 40.0]), np.zeros(2))
    network = connect(sources, [lobe, lobe], "isotropic")
    part = Interpolant(network, "isotropic")
    fits = [Fitted(part, "transmission_front"), Fitted(part, "reflection_front")]
    conserved = conserve_energy(fits)
    assert conserved.largest == pytest.approx(1.4)
    for fit in conserved.fits:
        share = fit.interpolant.hemispherical(from_degrees(20.0, 0.0))
        assert share == pytest.approx(0.5)


def test_one_direction_is_not_enough():
    lobe = Lobes(np.array([[0, 0, 1.0]]), np.array([0.2]), np.array([0.7]))
    with pytest.raises(InputError, match="two or more"):
        connect(from_degrees(np.array([10.0]), np.zeros(1)), [lobe], "isotropic")


def coating(incident):
    """Black coating: scattered light stays the same, a mirror's beam grows."""
    centre = np.array([incident * [-1, -1, 1], [0, 0, 1.0]])
    flux = np.array([0.01 + 0.3 * (1 - incident[2]) ** 5, 0.05])
    return Lobes(centre, np.array([0.15, 1.5]), flux)


def test_scattered_light_beside_a_beam_that_grows_stays_what_it_is():
    """The formula, half-way between 40° and 60°, more than 40° from the beam."""
    scans = Goniophotometer(points=1500, floor=0.0).measure(
        coating, rings(azimuths_deg=[0.0], step_deg=20.0, most_deg=60.0)
    )
    fitted = fit_measurement(scans)
    incident = from_degrees(50.0, 0.0)
    (found,) = fitted.interpolant.lobes_of(incident[None])
    truth = coating(incident)
    grid = hemisphere()
    away = angle_between(grid, truth.centre[0]) > np.radians(40)
    light = [part.evaluate(grid)[away].mean() for part in (found, truth)]
    assert light[0] == pytest.approx(light[1], rel=0.03)
