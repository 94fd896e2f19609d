"""Verdicts and requirements of standards, on results that can be counted by hand."""

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.metrics.compliance import assess
from clerestory.metrics.space import WHOLE, spaces_of
from clerestory.metrics.standards import STANDARDS, standards_named
from office_results import DAY, HOURS, SHAPES, office

COUNT = sum(a * b for a, b in SHAPES.values())


def found(data, name, space=WHOLE):
    assessments = assess(data, standards_named([name]))
    return next(one for one in assessments if one.space == space)


def level(data, name, criterion, space=WHOLE):
    verdicts = found(data, name, space).verdicts
    return next(one for one in verdicts if one.criterion.startswith(criterion))


def unfulfilled(data, name, space="south"):
    lines = found(data, name, space).requirements
    return {line.name: line for line in lines if line.status == "not fulfilled"}


def test_sda_of_all_spaces_is_weighted_by_floor_area():
    """20 and 30 of 62 sensors reach 300 lux; then the corner counts four times."""
    equal = level(office(), "LM-83", "Spatial")
    assert equal.quantities[0].value == pytest.approx(100 * 50 / 62)
    assert equal.words == "preferred"
    area = np.where(np.array(office()["grid"]) == "corner", 4.0, 1.0)
    weighted = level(office(floor_area=("sensor", area)), "LM-83", "Spatial")
    assert weighted.quantities[0].value == pytest.approx(100 * 50 / 98)
    assert weighted.words == "not accepted"
    assert level(office(), "LM-83", "Spatial", "corner").words == "not accepted"


def test_sensors_without_a_space_do_not_count():
    data = office()
    names = np.where(data["grid"] == "corner", "", data["grid"])
    data = data.assign(space=("sensor", names))
    assert [one.name for one in spaces_of(data)] == ["north", "south"]
    assert level(data, "LM-83", "Spatial").quantities[0].value == 100


@pytest.mark.parametrize(
    ("hours", "words"),
    [(250, "clearly acceptable"), (251, "unsatisfactory visual comfort")],
)
def test_ase_of_a_space_counts_more_than_250_hours(hours, words):
    data = office()
    lit = np.flatnonzero(DAY)[:hours]
    data["direct_open"][np.flatnonzero(data["grid"] == "south")[:4], lit] = 1500.0
    verdict = level(data, "LM-83", "Annual", "south")
    assert verdict.words == words
    assert verdict.quantities[1].value == hours
    assert level(data, "LM-83", "Annual", "north").words == "clearly acceptable"


def test_the_error_of_a_verdict_is_that_of_its_replicates():
    """All sensors of the corner at 300 ± 6 lux: half of the replicates reach it."""
    verdict = level(office(lux={"corner": 299.0}), "LM-83", "Spatial", "corner")
    assert verdict.level == 0
    assert verdict.quantities[0].error == pytest.approx(50.0)
    assert verdict.error == pytest.approx(1.0)
    assert level(office(), "LM-83", "Spatial", "corner").error == 0


def test_open_blinds_are_counted_in_the_hours_of_the_procedure():
    data = office()
    data["state"][1, HOURS[DAY][:365]] = 1
    verdict = level(data, "LM-83", "Spatial", "south")
    assert verdict.quantities[1].value == pytest.approx(90.0)
    assert level(data, "LM-83", "Spatial", "north").quantities[1].value == 100


@pytest.mark.parametrize(
    ("corner", "version", "points"),
    [
        (200.0, "LEED v4.1", "3 points"),
        (400.0, "LEED v4.1", "3 points, exemplary"),
        (400.0, "LEED v4", "3 points"),
    ],
)
def test_leed_points_are_those_of_all_spaces(corner, version, points):
    data = office(lux={"corner": corner})
    assert level(data, version, "Option").words == points
    assert level(data, version, "Option", "south").words == ""


def test_one_space_alone_has_the_points_of_leed():
    data = office()
    alone = data.isel(sensor=np.flatnonzero(data["grid"] == "south"))
    assert level(alone, "LEED v4", "Option", "south").words == "3 points"


def test_every_criterion_of_en17037_has_its_level():
    data = office()
    words = [one.words for one in found(data, "EN 17037", "south").verdicts]
    # 800 lux; 450 of 15,000 lux by factor; all views; 3 of 24 h; DGP 0.30
    assert words == ["high", "minimum", "high", "medium", "high"]
    words = [one.words for one in found(data, "EN 17037").verdicts]
    assert words == ["none", "minimum", "high", "medium", "high"]


def test_glare_is_that_of_the_worst_view_with_its_error():
    data = office()
    lit = np.flatnonzero(DAY)
    data["glare_dgp"][1, lit[:182]] = 0.5  # 182 of 3,650 hours are below 5 %
    assert level(data, "EN 17037", "Protection", "south").words == "high"
    data["glare_dgp"][1, lit[:183]] = 0.3505
    verdict = level(data, "EN 17037", "Protection", "south")
    assert verdict.words == "medium"
    assert verdict.error == pytest.approx(0.5)
    assert level(data, "EN 17037", "Protection", "north").words == "high"


def test_glare_is_also_that_of_the_positions_of_view_grids_of_the_space():
    """Two positions by two directions; the second position is in the north."""
    grid = {
        "grid_view_space": ("grid_view", ["south", "south", "north", "north"]),
        "grid_view_exceeded_dgp": ("grid_view", [0.2, 0.399, 0.46, np.nan]),
        "grid_view_exceeded_dgp_error": ("grid_view", [0.01, 0.002, 0.001, np.nan]),
    }
    data = office(**grid)
    south = level(data, "EN 17037", "Protection", "south")
    assert south.quantities[0].value == pytest.approx(0.399)
    assert south.words == "medium"
    assert south.quantities[0].error == pytest.approx(0.002)
    assert south.error == pytest.approx(0.5)
    assert level(data, "EN 17037", "Protection", "north").words == "none"
    assert level(data, "EN 17037", "Protection", "corner").words == "high"
    alone = office(**grid, glare_dgp=None)
    assert level(alone, "EN 17037", "Protection", "south").words == "medium"
    assert level(alone, "EN 17037", "Protection", "corner").words == "not known"


def test_roof_lights_have_to_reach_the_target_on_95_percent_of_the_area():
    data = office(window_normal=(("window", "xyz"), np.tile([0, 0, -1.0], (3, 1))))
    south = np.flatnonzero(data["grid"] == "south")
    data["illuminance"][south[:3]] = 120.0 * DAY  # 10 % of the sensors
    assert level(data, "EN 17037", "Daylight provision by ill", "south").level == 0
    side = office()
    side["illuminance"][south[:1]] = 120.0 * DAY
    assert level(side, "EN 17037", "Daylight provision by ill", "south").level == 3


def test_breeam_counts_hours_and_factors():
    verdicts = found(office(), "BREEAM", "south").verdicts
    assert [one.words for one in verdicts] == ["met", "met"]
    assert verdicts[0].quantities[0].value == DAY.sum()
    uneven = office(daylight_factor=("sensor", np.linspace(0.001, 0.06, COUNT)))
    assert level(uneven, "BREEAM", "Daylight factor", "north").words == "not met"


@pytest.mark.parametrize(
    ("kind", "mean", "lowest", "hours"),
    [
        ("office", 300, 90, 2000),
        ("school", 300, 90, 2000),
        ("healthcare patients", 300, 90, 2000),
        ("residential kitchen", 100, 30, 3450),
        ("residential communal", 200, 60, 2650),
        ("prison association", 300, 210, 2650),
        ("prison cell", 100, 0, 3150),
    ],
)
def test_breeam_requires_what_its_table_says_for_a_type_of_space(
    kind, mean, lowest, hours
):
    """Figures of table 5.3 as Pollination's documentation of its recipe repeats it."""
    study = {"space": [{"name": "south", "breeam_type": kind}]}
    rows = np.flatnonzero(office()["grid"] == "south")
    lit = np.flatnonzero(DAY)
    for change, words in ((0, "met"), (-1, "not met")):
        data = office(lux={"south": 0.0}, study=study)
        bright = (mean * len(rows) - lowest) / (len(rows) - 1) + 1e-6
        for row, lux in zip(rows, [lowest, *[bright] * len(rows)], strict=False):
            data["illuminance"][row, lit[: hours + change]] = lux
        assert level(data, "BREEAM", "Illuminance", "south").words == words
    factor = level(data, "BREEAM", "Daylight factor", "south").words
    assert factor == ("met" if kind == "office" else "not known")


def test_a_standard_that_lacks_an_input_is_not_known():
    names = "sun_hours direct_open daylight_hours daylight_factor view_width"
    data = office().drop_vars([*names.split(), "sun_reaches", "glare_dgp"])
    for name in STANDARDS:
        verdicts = found(data, name, "south").verdicts
        assert {one.words for one in verdicts} <= {"not known", "", "met"} | {
            "preferred"
        }


def test_an_unknown_standard_is_named():
    with pytest.raises(InputError, match="standard is 'LM-84'"):
        standards_named(["LM-84"])


def moved(name, change):
    """Return results with one variable changed by a function."""
    data = office()
    return data.assign_coords({name: change(data[name])})


def half_year():
    return office().isel(time=slice(0, 4380))


def rule(name):
    tables = [{"name": n, "control": {"rule": name}} for n in SHAPES]
    return {"window": tables}


BREAKS = [
    ("LM-83-12", "Period", half_year),
    ("LM-83-12", "Time step", lambda: office().assign_attrs(step_minutes=120.0)),
    ("LM-83-12", "Grid spacing", lambda: office(spacing=0.7)),
    (
        "LM-83-12",
        "Direction of the sensors",
        lambda: moved("direction", lambda x: x * -1),
    ),
    (
        "LM-83-12",
        "Height of the grid",
        lambda: office(height_above_floor=("sensor", np.full(COUNT, 0.85))),
    ),
    ("LM-83-12", "Operation of the blinds", lambda: office(study=rule("glare"))),
    ("LM-83-12", "Limits of the blinds", lambda: office(control={"sun_lux": 2e3})),
    (
        "LM-83-12",
        "Hours of the blinds",
        lambda: office(control={"when_empty": 1}, occupied=("time", HOURS % 24 == 9)),
    ),
    ("LM-83-12", "Sensors of the blinds", lambda: office(control={"grid": "north"})),
    (
        "LM-83-12",
        "Blinds",
        lambda: office(sun={"south": 2e3}).drop_vars(
            ["control", "state", "state_name"]
        ),
    ),
    ("LM-83-12", "Direct sunlight", lambda: office(sun_hours=None)),
    (
        "LM-83-12",
        "Weather",
        lambda: office(study={"weather": {"clear_sky": {"turbidity": 3}}}),
    ),
    ("LEED v4", "Sunlight exposure", lambda: office(sun={"south": 2e3})),
    ("LEED v4.1", "Sunlight exposure", lambda: office(sun={"south": 2e3})),
    ("EN 17037", "Period", half_year),
    ("EN 17037", "Grid spacing", lambda: office(spacing=20.0)),
    (
        "EN 17037",
        "Height of the grid",
        lambda: office(height_above_floor=("sensor", np.full(COUNT, 0.70))),
    ),
    ("EN 17037", "Views for glare", lambda: office(glare_dgp=None)),
    (
        "EN 17037",
        "Openings for sunlight",
        lambda: office(sun_reaches=None, opening_space=None),
    ),
    ("EN 17037", "Openings for the view out", lambda: office(view_width=None)),
    ("EN 17037", "Weather", lambda: office(study={"weather": {"measured": {"a": 1}}})),
    ("BREEAM", "Period", half_year),
    ("BREEAM", "Daylight factors", lambda: office(daylight_factor=None)),
    (
        "BREEAM",
        "Height of the grid",
        lambda: office(height_above_floor=("sensor", np.full(COUNT, 0.85))),
    ),
]

# LM-83-23 and LEED have the procedure of LM-83-12
BREAKS += [
    (standard, name, broken)
    for standard in ("LM-83-23", "LEED v4", "LEED v4.1")
    for known, name, broken in BREAKS
    if known == "LM-83-12"
]
BREAKS += [
    (standard, name, broken)
    for standard in ("EN 17037", "BREEAM")
    for known, name, broken in BREAKS
    if known == "LM-83-12"
    and name in ("Time step", "Direction of the sensors", "Weather")
]


@pytest.mark.parametrize("standard", STANDARDS)
def test_every_requirement_is_broken_below(standard):
    """Those of which the results never tell whether they are fulfilled are left out.

    Standards evaluate the hours of the day that they require; other hours are evaluated
    and reported by `lm83_conditions.departures` alone.
    """
    known = {
        line.name
        for data in (office(), office(sun={"south": 2e3}))
        for line in found(data, standard, "south").requirements
        if line.status != "not known" or line.found != "not part of the results"
    }
    assert known - {"Hours of the day"} <= {
        name for own, name, _ in BREAKS if own == standard
    }
    assert len(known) > 5


@pytest.mark.parametrize(("standard", "name", "broken"), BREAKS)
def test_a_requirement_that_is_broken_is_not_fulfilled(standard, name, broken):
    """Each of them is fulfilled in the office as it is, or is not listed."""
    heights = {"EN 17037": 0.85, "BREEAM": 0.70}.get(standard, 0.76)
    whole = office(height_above_floor=("sensor", np.full(COUNT, heights)))
    assert unfulfilled(whole, standard) == {}
    line = unfulfilled(broken(), standard)[name]
    assert line.change
    assert line.expected


def test_height_of_an_unknown_floor_is_not_known():
    lines = found(office(height_above_floor=None), "LM-83", "south").requirements
    line = next(one for one in lines if one.name == "Height of the grid")
    assert line.status == "not known"
    assert line.change
