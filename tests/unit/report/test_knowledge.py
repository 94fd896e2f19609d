"""Section on what is not known: a linear Gaussian case with known shares."""

import re

import numpy as np
import pytest
import xarray as xr
from lxml import html

from clerestory.report.content_from_results import from_results
from clerestory.report.knowledge_section import known_figures, probabilities
from clerestory.report.page import report_page
from clerestory.study.results import Results

NAMES = ("mean illuminance", "hours with 300 lux or more", "useful illuminance")
LAST = ("hours above the useful range", "area with 300 lux in half of the hours")
UNITS = ("lux", "%", "%", "%", "%")


@pytest.fixture(scope="module")
def results(room):
    """A glass of 64 % and a floor of 36 % of the variance of every figure."""
    own = room.analytic_results(times=room.year(days=60))
    draws = np.random.default_rng(1).standard_normal((2, 512))
    values = np.array([500.0, 60.0, 70.0, 5.0, 80.0])[:, None]
    varied = values + np.array([0.8, 0.6]) @ draws * np.array(
        [[50], [5], [4], [1], [6]]
    )
    axis = "known_figure"
    told = xr.Dataset(
        {
            "known_figure_name": (axis, np.array([*NAMES, *LAST])),
            "known_figure_place": (axis, np.array(["desks"] * 5)),
            "known_figure_unit": (axis, np.array(UNITS)),
            "known_figure_value": (axis, values[:, 0]),
            "known_figure_error": (axis, np.full(5, 0.2)),
            "known_figure_mean": (axis, varied.mean(axis=1)),
            "known_figure_deviation": (axis, varied.std(axis=1)),
            "known_figure_quantile": (
                (axis, "quantile"),
                np.quantile(varied, (0.05, 0.5, 0.95), axis=1).T,
            ),
            "known_figure_draws": ((axis, "draw"), varied),
            "unknown_draws": (("draw", "unknown"), draws.T),
            "unknown_reference": ("unknown", [0.8, 0.3]),
            "unknown_mean": ("unknown", [0.8, 0.3]),
            "unknown_deviation": ("unknown", [0.05, 0.05]),
            "unknown_low": ("unknown", [0.72, 0.22]),
            "unknown_high": ("unknown", [0.88, 0.38]),
            "unknown_kind": ("unknown", np.array(["dirt", "reflectance"])),
            "unknown_shape": ("unknown", np.array(["normal", "uniform"])),
            "first_index": ((axis, "unknown_group"), np.tile([0.64, 0.36], (5, 1))),
            "total_index": ((axis, "unknown_group"), np.tile([0.64, 0.36], (5, 1))),
            "probability": ("probable", [0.82]),
            "probable_standard": ("probable", np.array(["LEED v4.1"])),
            "probable_space": ("probable", np.array(["desks"])),
            "probable_criterion": ("probable", np.array(["Option 1"])),
            "probable_level": ("probable", np.array(["3 points"])),
            "check_traced": (("check", "checked_figure"), [[505.0, 61, 70, 5, 80]]),
            "check_expanded": (("check", "checked_figure"), [[455.0, 60, 70, 5, 80]]),
            "check_fails": (
                ("check", "checked_figure"),
                [[True, False, False, False, False]],
            ),
        },
        coords={
            "unknown": np.array(["glass", "floor <b>"]),
            "unknown_group": np.array(["glass", "floor <b>"]),
        },
    )
    return Results(own.data.merge(told), own.run)


@pytest.fixture(scope="module")
def section(results):
    page = html.document_fromstring(report_page(from_results(results)))
    (found,) = page.xpath("//section[@id='knowledge']")
    return found


@pytest.mark.parametrize(
    ("value", "words"),
    [(0, "0 %"), (0.004, "below 1 %"), (0.824, "82 %"), (0.996, "above 99 %"),
     (1, "100 %")],
)  # fmt: skip
def test_certainty_is_not_claimed_by_rounding(results, value, words):
    data = results.data.assign(probability=("probable", [value]))
    assert probabilities(data)[0][1][-1] == words


def test_every_figure_has_both_errors_and_its_cause(results):
    first = known_figures(results.data)[0]
    assert first.simulation == "500.0 ± 0.2 lux"
    spread = float(first.knowledge.split()[1])
    assert spread == pytest.approx(50, rel=0.1)
    assert first.cause == "glass (64 %), floor <b> (36 %)"


def test_the_key_figures_show_both_errors(results):
    page = html.document_fromstring(report_page(from_results(results)))
    shown = page.xpath("//dl[@class='key-figures']")[0].text_content()
    assert "lux from what is not known exactly" in shown


def test_the_section_tells_what_to_measure_first(section):
    words = section.text_content()
    assert "The largest part comes from glass (64 %)" in words
    assert "measure that first" in words
    assert "their shares, to about 100 %" in words
    assert re.search(r"between [\d.]+ and [\d.]+ %", words)


def test_the_section_tells_what_each_quantity_is(section):
    words = section.text_content()
    assert "share of the light that dirt lets pass" in words
    assert "share of the light that it reflects" in words


def test_probabilities_and_failed_checks_are_shown(results, section):
    (row,) = probabilities(results.data)
    assert row == ("LEED v4.1: Option 1", ["desks", "3 points", "82 %"])
    words = section.text_content()
    assert "82 %" in words
    assert "455 / 505 lux (fails)" in words


def test_widths_of_the_bars_are_the_shares(section):
    bars = section.xpath(".//*[local-name()='svg']")[-1]
    widths = [
        float(own.get("width")) for own in bars.xpath(".//*[local-name()='rect']")[:2]
    ]
    assert widths[0] / sum(widths) == pytest.approx(0.64, abs=0.005)


def test_names_are_escaped(section):
    assert not section.xpath(".//b[contains(text(), 'floor')]")


def test_no_section_without_uncertainty(room):
    page = report_page(from_results(room.analytic_results(times=room.year(days=60))))
    assert 'id="knowledge"' not in page
