"""The data of the interactive view are the BSDF's, compact, and safe in a page."""

import base64
import gzip
import hashlib
import re

import numpy as np
import pytest
from lxml import html

from clerestory.bsdf.analytic import lambertian, thin_pane
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.resample import to_trees
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.report import bsdf_view
from clerestory.report.bsdf_view import (
    fine_partition,
    value_codes,
    view_data,
    view_page,
)

QUARTER = klems("quarter")


def decoded(part):
    """Values as the page's script decodes them, (exit, incident)."""
    codes = np.frombuffer(gzip.decompress(base64.b64decode(part["codes"])), "<u2")
    values = np.where(
        codes > 0, part["high"] * np.exp((codes - 65535.0) * part["step"]), 0
    )
    return values.reshape(sum(part["incidents"]["count"]), -1).T


def test_codes_keep_four_digits_over_six_decades():
    values = np.geomspace(1e-5, 5, 1000)
    part = {
        "codes": base64.b64encode(gzip.compress(value_codes(values, 5.0).tobytes())),
        "high": 5.0,
        "step": 6 * np.log(10) / 65534,
        "incidents": {"count": [1]},
    }
    np.testing.assert_allclose(decoded(part)[:, 0], values, rtol=2e-4)
    assert value_codes(np.array([0.0, 1e-9, 5.0]), 5.0).tolist() == [0, 0, 65535]


def test_a_matrix_is_shown_on_its_own_patches():
    pane = thin_pane(0.9, QUARTER)
    part = view_data(pane)["functions"][0]
    assert (part["channel"], part["name"]) == ("visible", "transmission_front")
    np.testing.assert_allclose(
        decoded(part), pane.function("transmission_front").values, rtol=2e-4
    )
    np.testing.assert_allclose(part["share"], pane.direct_hemispherical(), atol=1e-5)


def test_a_tree_is_shown_on_fine_cells_with_its_flux():
    tree = to_trees(lambertian(0.4, QUARTER), halvings=3)
    part = view_data(tree)["functions"][0]
    assert part["exits"]["name"] == "View"
    flux = fine_partition().projected_solid_angles() @ decoded(part)
    np.testing.assert_allclose(flux, 0.4, rtol=1e-3)


def test_what_does_not_fit_the_page_is_named_on_it(monkeypatch):
    monkeypatch.setattr(bsdf_view, "_MOST_VALUES", 2 * 41 * 41)
    layer = lambertian(0.4, QUARTER)
    data = view_data(layer)
    assert len(data["functions"]) == 2
    assert data["left_out"] == [
        "visible transmission back",
        "visible reflection back",
    ]
    words = html.document_fromstring(view_page(layer)).text_content()
    assert "Not on this page" in words
    assert "visible transmission back, visible reflection back" in words


def test_a_huge_matrix_is_shown_on_coarser_patches(monkeypatch):
    monkeypatch.setattr(bsdf_view, "_MOST_VALUES_OF_ONE", 1000)
    part = view_data(single(0.3))["functions"][0]
    assert part["exits"]["name"] == "View"
    flux = fine_partition().projected_solid_angles() @ decoded(part)
    np.testing.assert_allclose(flux, 0.3, rtol=1e-3)


def single(share):
    """A Lambertian transmission on 41 patches."""
    layer = lambertian(share, QUARTER)
    key = ("visible", "transmission_front")
    return Bsdf({key: layer.functions[key]})


def test_a_page_of_a_tree_stays_small():
    """Four noisy functions of 2353 × 145 values stay below 10 MB."""
    noise = np.random.default_rng(1).random((len(fine_partition()), 145))
    codes = value_codes(noise, 1.0)
    assert 4 * len(base64.b64encode(gzip.compress(codes.tobytes(), 6))) < 10e6


def test_the_page_runs_its_own_script_only():
    page = view_page(lambertian(0.5, QUARTER))
    document = html.document_fromstring(page)
    policy = document.xpath("string(//meta[@http-equiv]/@content)")
    script = re.search(r"<script>(.*)</script>", page, re.DOTALL)[1]
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    assert f"script-src 'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy


def test_names_cannot_become_markup():
    hostile = Product(name="</script><script>alert(1)</script>")
    page = view_page(Bsdf(lambertian(0.5, QUARTER).functions, hostile))
    assert "<script>alert" not in page


def test_the_findings_are_below_the_view():
    sound = view_page(lambertian(0.5, QUARTER))
    assert "No fault found in energy balance, reciprocity and labels" in sound
    bright = lambertian(0.7, QUARTER)
    functions = dict(bright.functions)
    functions["visible", "reflection_front"] = functions["visible", "transmission_back"]
    assert "can change results" in view_page(Bsdf(functions))


def test_nothing_to_show_is_refused():
    with pytest.raises(InputError, match="no transmittance or reflectance"):
        view_page(Bsdf({}))
