"""Figures of BSDFs show the numbers they are drawn from, the right way up."""

import io

import numpy as np
import pytest

from clerestory.bsdf.analytic import clear_air, lambertian
from clerestory.bsdf.layer_comparison import compare
from clerestory.bsdf.resample import to_trees
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.report.bsdf_plot import (
    direction_from_angles,
    lobe_figure,
    patch_direction,
    share_figure,
)

FULL = klems("full")


def discs(figure):
    return [axes.images[0].get_array() for axes in figure.axes if axes.images]


def saved(figure):
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=50)
    return stream.getvalue()


@pytest.mark.parametrize("function", ["transmission_front", "reflection_back"])
def test_a_lambertian_disc_is_even(function):
    bsdf = lambertian(0.5, FULL, reflectance=0.5)
    (disc,) = discs(
        lobe_figure([bsdf], [patch_direction(64, function)], function=function)
    )
    assert np.allclose(disc.compressed(), 0.5 / np.pi)


def test_light_from_above_goes_on_downwards_through_air():
    """Source 40° up: the one bright patch of air lies at 40° below the middle."""
    source = direction_from_angles(40, 90, "transmission_front")
    (disc,) = discs(lobe_figure([clear_air(FULL)], [source]))
    rows, columns = np.nonzero(disc.filled(0) > 0.99 * disc.max())
    to_degrees = 180 / disc.shape[0]
    assert (rows.mean() + 0.5) * to_degrees - 90 == pytest.approx(-40, abs=1)
    assert (columns.mean() + 0.5) * to_degrees - 90 == pytest.approx(0, abs=0.5)


def test_patch_directions_are_those_of_the_incident_patches():
    for function, sign in (("transmission_front", -1), ("transmission_back", 1)):
        direction = patch_direction(47, function)
        assert np.sign(direction[2]) == sign
        assert FULL.find(np.array([*-direction[:2], abs(direction[2])])) == 47


def test_curves_show_the_share_scattered_in_all():
    figure = share_figure([lambertian(0.3, FULL), lambertian(0.6, FULL)], names="ab")
    lines = figure.axes[0].get_lines()
    assert [line.get_label() for line in lines] == ["a", "b"]
    assert np.allclose(lines[1].get_ydata(), 0.6)


def test_a_comparison_draws_layers_side_by_side():
    directions = [patch_direction(k, "transmission_front") for k in (64, 122)]
    figure = lobe_figure(
        [lambertian(0.3, FULL), clear_air(FULL)], directions, names=["one", "two"]
    )
    assert len(discs(figure)) == 4
    assert saved(figure).startswith(b"\x89PNG")


def test_a_missing_function_and_a_missing_patch_are_refused():
    with pytest.raises(InputError, match="0 to 144"):
        patch_direction(145, "transmission_front")
    with pytest.raises(InputError, match="no solar"):
        share_figure([lambertian(0.3, FULL)], channel="solar")


def test_differences_are_those_of_the_closed_form():
    result = compare(lambertian(0.2, FULL), lambertian(0.3, FULL))
    assert result.rms == pytest.approx(0.1 / np.pi)
    assert result.mean == pytest.approx(0.2 / np.pi)
    assert result.redistributed == pytest.approx(0.1 / 0.5)
    assert result.diffuse == pytest.approx((0.2, 0.3))


def test_layers_on_other_patches_are_compared_on_the_coarser_ones():
    """Of Lambertian layers every average is known; a tree counts as 145 patches."""
    fine, coarse = lambertian(0.2, FULL), lambertian(0.3, klems("half"))
    for pair in ((fine, coarse), (to_trees(fine, halvings=2), coarse)):
        result = compare(*pair)
        assert result.incidents.matches(klems("half"))
        assert result.rms == pytest.approx(0.1 / np.pi)
        assert result.redistributed == pytest.approx(0.1 / 0.5)
    tree = compare(to_trees(fine, halvings=2), fine)
    assert tree.incidents.matches(FULL)
    assert tree.rms < 1e-6
