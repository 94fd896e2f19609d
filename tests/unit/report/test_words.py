"""Numbers, tables and facts in words."""

import numpy as np
import pytest
from lxml import html

from clerestory.report.content_from_results import (
    from_results,
    place_words,
    run_tables,
    schedule_words,
    study_tables,
)
from clerestory.report.main_sections import duration, time_table
from clerestory.report.markup import element, embedded_json
from clerestory.report.metric_maps import metric_maps
from clerestory.report.uncertain_value import Figure
from clerestory.report.uncertainty import error_words


@pytest.mark.parametrize(
    ("figure", "words"),
    [
        (Figure(1659.4, 15.2, "lux"), "1,659 ± 15 lux"),
        (Figure(612.34, 0.31, "lux"), "612.3 ± 0.3 lux"),
        (Figure(4.8, 0.052, "%"), "4.80 ± 0.05 %"),
        (Figure(4.8, 0.0004, "%"), "4.80 ± <0.01 %"),
        (Figure(16.45, 0.0, "%"), "16.4 %"),
        (Figure(0.0, 0.0, "lux"), "0 lux"),
    ],
)
def test_figures_show_the_digits_that_their_error_allows(figure, words):
    assert str(figure) == words


def test_the_four_useful_bands_fill_the_hours(room):
    content = from_results(room.analytic_results(times=room.year(days=20)))
    bands = [m.values for m in metric_maps(content.metrics)[2:]]
    assert len(bands) == 4
    assert np.allclose(np.sum(bands, axis=0), 100)


def test_errors_of_the_bands_follow_from_hours_near_their_limits(room):
    """Hours within one error of 3000 lux may or may not exceed it."""
    content = from_results(room.analytic_results(times=room.year(days=20)))
    exceeded = metric_maps(content.metrics)[-1]
    lux = content.illuminance[:, content.occupied]
    error = content.standard_error[:, content.occupied]
    near = (lux + error >= 3000) & (lux - error < 3000)
    assert np.allclose(exceeded.errors, 50 * near.mean(axis=1), atol=1e-4)


def test_the_accuracy_is_reported_in_one_sentence(room):
    results = room.analytic_results(times=room.year(days=20))
    results.data["standard_error"].values[:] = 0.02 * results.data["illuminance"].values
    assert "half of them are below 2 %, 95 % below 2 %" in error_words(
        from_results(results)
    )


def test_results_without_errors_say_so(room):
    results = room.analytic_results(times=room.year(days=2))
    results.data["standard_error"].values[:] = 0
    assert "no statistical error" in error_words(from_results(results))


def test_southern_and_western_places_keep_their_side():
    attrs = {"place": "Santiago", "latitude_deg": -33.4, "longitude_deg": -70.7}
    assert place_words(attrs, {}) == "Santiago (33.40° S, 70.70° W)"
    assert place_words({}, {"weather": {"file": "oslo.epw"}}) == "oslo.epw"


def test_no_schedule_means_all_hours():
    times = np.array(["2023-03-21T12:30"], "datetime64[s]")
    assert schedule_words({}, times) == "at all hours"


def test_facts_come_as_tables_whatever_they_are():
    study = {"title": "t", "window": [{"name": "w", "file": "w.rad"}], "sky": {"mf": 4}}
    assert [table.title for table in study_tables(study)] == ["Window w", "Sky"]
    run = {
        "seed": 3,
        "versions": {"numpy": "2"},
        "matrices": {f"view-south-{'3f2a' * 8}.nc": {"found": True}},
    }
    tables = {table.title: dict(table.rows) for table in run_tables(run)}
    assert tables["Run"] == {"Seed": "3"}
    assert tables["Versions"] == {"numpy": "2"}
    assert tables["Matrices"] == {
        "Kept from an earlier run": "1",
        "Names of their files": "in run.json",
    }


@pytest.mark.parametrize(
    ("method", "shown"),
    [("2-phase", True), ("4-phase", False), (["3-phase", "6-phase"], True)],
)
def test_the_sun_is_shown_by_methods_with_the_direct_correction(method, shown):
    tables = study_tables({"method": method, "sun": {"places": "exact"}})
    assert [table.title for table in tables] == ["Sun"] * shown


def test_the_tables_of_a_study_keep_the_order_of_the_light():
    study = {"trace": {"seed": 1}, "sky": {"mf": 4}, "scene": {"files": []}}
    assert [t.title for t in study_tables(study)] == ["Scene", "Sky", "Trace"]


def test_the_longest_phase_comes_first():
    table = html.fromstring(time_table({"read": 0.1, "trace": 7.0, "sky": 2.0}))
    heads = [th.text for th in table.iter("th")]
    assert heads == ["trace", "sky", "read", "Total"]


def test_durations_are_in_readable_units():
    assert duration(7384) == "2 h 3 min"


def test_attributes_cannot_be_broken_out_of():
    assert element("p", title='"><script>') == '<p title="&#34;&gt;&lt;script&gt;"></p>'


def test_embedded_data_cannot_close_their_element():
    assert "</script><" not in embedded_json("d", {"a": "</script><script>"})
