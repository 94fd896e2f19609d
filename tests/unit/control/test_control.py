"""States of shades by rule: sun, thresholds, glare, direct sun, files, own rules."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from clerestory.control.control_rule import Situation, apply_rule
from clerestory.control.lm83_blinds import operate_by_direct_sun
from clerestory.control.profile_angle import (
    blocking_states,
    cut_off_tilt,
    direct_share,
    profile_angle,
)
from clerestory.control.schedule import (
    StateSchedule,
    read_schedule,
    select_states,
    write_schedule,
)
from clerestory.control.state_choice import (
    Limit,
    best_states,
    least_closed,
    when_occupied,
)
from clerestory.control.threshold import staged_states, threshold_states
from clerestory.directions import Frame, from_azimuth
from clerestory.errors import InputError
from clerestory.glazing.pane import grey_pane
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.venetian import VenetianBlind

SOUTH = Frame.from_normal_up(np.array([0.0, 1.0, 0.0]), np.array([0.0, 0.0, 1.0]))
HOURS = np.datetime64("2001-03-21T00:30", "s") + np.arange(24) * np.timedelta64(1, "h")


def test_the_profile_angle_of_a_sun_in_front_is_its_altitude():
    altitude = np.radians(np.array([10.0, 45.0, 80.0]))
    sun = from_azimuth(np.full(3, np.pi), altitude)
    assert np.allclose(profile_angle(sun, SOUTH), altitude)


def test_the_profile_angle_grows_for_a_sun_at_the_side():
    """tan ψ = tan(altitude)/cos(azimuth from the normal)."""
    altitude, off = np.radians(30.0), np.radians(60.0)
    sun = from_azimuth(np.array([np.pi + off]), np.array([altitude]))
    expected = np.arctan(np.tan(altitude) / np.cos(off))
    assert profile_angle(sun, SOUTH)[0] == pytest.approx(expected)


def test_a_sun_behind_the_window_has_no_profile_angle():
    north = from_azimuth(np.array([0.0]), np.array([0.5]))
    assert np.isnan(profile_angle(north, SOUTH))[0]


@given(
    profile_deg=st.floats(0, 85),
    ratio=st.floats(0.3, 0.99),
)
def test_the_cut_off_tilt_just_stops_the_sun(profile_deg, ratio):
    profile = np.radians(np.array([profile_deg]))
    tilt = cut_off_tilt(profile, width=1.0, spacing=ratio)
    assert direct_share(profile, tilt, width=1.0, spacing=ratio)[0] < 1e-9
    if tilt[0] > 1e-3:
        less = direct_share(profile, tilt - 1e-3, width=1.0, spacing=ratio)
        assert less[0] > 0


def test_the_share_that_passes_is_that_of_the_blind():
    """The blind of `glazing`, which counts lines, says the same."""
    for tilt_deg in (-20, 35):
        slats = SlatGeometry(width=0.05, spacing=0.04, tilt=np.radians(tilt_deg))
        blind = VenetianBlind(grey_pane(0, 0), slats)
        for profile in np.radians([-30.0, 0.0, 20.0, 50.0]):
            travel = np.array([[0.0, -np.sin(profile), np.cos(profile)]])
            ours = direct_share(
                np.array([profile]), slats.tilt, width=0.05, spacing=0.04
            )
            assert ours[0] == pytest.approx(blind.openness(travel)[0], abs=2e-3)


def test_the_most_open_tilt_that_stops_the_sun_is_chosen():
    """Crash course blind, 80 mm slats every 72 mm: cut-off tilt at ψ 30° is 21°."""
    tilts = np.radians([0.0, 20.0, 25.0, 45.0, 90.0])
    states = blocking_states(
        np.radians(np.array([30.0, 70.0, -10.0])),
        tilts=tilts,
        width=0.08,
        spacing=0.072,
    )
    assert states.tolist() == [2, 0, 4]
    dull = blocking_states(
        np.radians(np.array([30.0])),
        tilts=tilts,
        width=0.08,
        spacing=0.072,
        sunny=np.array([False]),
    )
    assert dull.tolist() == [0]


def test_hysteresis_keeps_a_shade_still_between_its_thresholds():
    signal = np.array([0, 260, 220, 190, 260, 220, 140, 220], dtype=float)
    states = threshold_states(signal, close_above=250, open_below=150)
    assert states.tolist() == [0, 1, 1, 1, 1, 1, 0, 0]


def test_a_delay_counts_consecutive_steps():
    signal = np.array([300, 100, 300, 300, 300, 100, 300, 100, 100], dtype=float)
    states = threshold_states(signal, close_above=200, close_after=2, open_after=2)
    assert states.tolist() == [0, 0, 0, 1, 1, 1, 1, 1, 0]


def test_missing_values_do_not_move_the_shade():
    signal = np.array([300, np.nan, np.nan, 100], dtype=float)
    assert threshold_states(signal, close_above=200).tolist() == [1, 1, 1, 0]


def test_stages_close_one_after_another():
    signal = np.array([100, 300, 600, 450, 100], dtype=float)
    states = staged_states(
        signal,
        close_above=np.array([250.0, 500.0]),
        open_below=np.array([200.0, 400.0]),
    )
    assert states.tolist() == [0, 1, 2, 2, 0]


@pytest.mark.parametrize(
    "fault", [{"open_below": 300.0}, {"close_after": 0}, {"start": 2}]
)
def test_thresholds_that_cannot_be_are_refused(fault):
    with pytest.raises(InputError, match="expected"):
        threshold_states(np.zeros(2), **({"close_above": 200.0} | fault))


def test_glare_takes_the_least_closed_state_that_is_good():
    dgp = np.array([[0.5, 0.3, 0.7], [0.39, 0.2, 0.6], [0.2, 0.1, 0.5]])
    assert least_closed([Limit(dgp, 0.4)]).tolist() == [1, 0, 2]


def test_the_best_state_keeps_its_limits_and_ties_stay_open():
    score = np.array([[9.0, 5.0, 1.0], [5.0, 5.0, 2.0]])
    glare = Limit(np.array([[0.5, 0.2, 0.6], [0.3, 0.2, 0.5]]), 0.4)
    assert best_states(score, [glare]).tolist() == [1, 0, 1]
    assert best_states(score).tolist() == [0, 0, 1]


def test_limits_work_both_ways():
    lux = Limit(np.array([[600.0, 100.0], [200.0, 50.0]]), 300.0, "above")
    assert least_closed([lux]).tolist() == [0, 0]


def test_an_empty_room_has_its_own_state():
    states = when_occupied(np.array([2, 1]), np.array([False, True]), otherwise=0)
    assert states.tolist() == [0, 1]


def three_groups():
    """Sun on 100 sensors from three windows: 1, 2 and 50 of them, then none."""
    sun = {}
    for group, count in {"a": 1, "b": 2, "c": 50}.items():
        lux = np.zeros((2, 100, 2))
        lux[0, :count, 0] = 1500.0
        lux[1] = 0.02 * lux[0]
        sun[group] = lux
    return sun


def test_only_as_many_blinds_close_as_the_rule_needs():
    """2 of 100 sensors may be in the sun, so c alone has to close."""
    found = operate_by_direct_sun(three_groups())
    assert {g: s.tolist() for g, s in found.states.items()} == {
        "a": [0, 0],
        "b": [0, 0],
        "c": [1, 0],
    }
    assert found.kept.all()


def test_sun_through_windows_without_blinds_breaks_the_rule():
    static = np.zeros((100, 2))
    static[:10, 1] = 5000.0
    found = operate_by_direct_sun(three_groups(), static=static)
    assert found.kept.tolist() == [True, False]
    assert found.states["a"].tolist() == [0, 1]


def test_many_groups_are_closed_one_by_one():
    """Nine groups have 512 combinations; the one in the sun closes."""
    sun = {f"g{i}": np.zeros((2, 50, 1)) for i in range(9)}
    sun["g4"][0, :30] = 2000.0
    found = operate_by_direct_sun(sun)
    assert {g for g, s in found.states.items() if s[0]} == {"g4"}
    assert found.kept.all()


def test_a_schedule_picks_and_sums():
    rng = np.random.default_rng(3)
    by_state = {"a": rng.random((3, 5, 24)), "b": rng.random((2, 5, 24))}
    states = {"a": rng.integers(0, 3, 24), "b": rng.integers(0, 2, 24)}
    static = rng.random((5, 24))
    total = StateSchedule(HOURS, states).total(by_state, static=static)
    for t in range(24):
        expected = static[:, t] + sum(by_state[g][states[g][t], :, t] for g in "ab")
        assert np.allclose(total[:, t], expected)


def test_a_state_that_does_not_exist_is_refused():
    with pytest.raises(InputError, match="state is 2; a number from 0 to 1"):
        select_states(np.zeros((2, 3, 4)), np.array([0, 1, 2, 0]))


def test_a_schedule_is_written_and_read_back(tmp_path):
    states = {"south": np.arange(24) % 3, "east, upper": np.zeros(24, int)}
    with_comma = StateSchedule(HOURS, {"south": states["south"]})
    write_schedule(tmp_path / "s.csv", with_comma)
    back = read_schedule(tmp_path / "s.csv")
    assert np.array_equal(back.times, HOURS)
    assert np.array_equal(back.states["south"], states["south"])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", r"s\.csv:1: no header"),
        ("time,a\n2001-01-01T00:30,x\n", r"s\.csv:2: .*a state from 0"),
        ("time,a\nyesterday,1\n", r"s\.csv:2: .*a time"),
        ("time,a,b\n2001-01-01T00:30,1\n", r"s\.csv:2: .*for each of a, b,"),
        ("time,a\n2001-01-01T00:30,-1\n", r"s\.csv:2: .*from 0 to 10000"),
    ],
)
def test_a_faulty_schedule_is_reported_with_its_line(tmp_path, text, words):
    path = tmp_path / "s.csv"
    path.write_text(text)
    with pytest.raises(InputError, match=words):
        read_schedule(path)


def test_a_rule_of_ones_own_is_checked():
    here = Situation(
        HOURS,
        2,
        np.ones(24, bool),
        {"irradiance": np.arange(24.0)},
        {"dgp": np.zeros((2, 24))},
    )
    assert (
        apply_rule(lambda s: (s.signals["irradiance"] > 20).astype(int), here).sum()
        == 3
    )
    for rule, words in (
        (lambda s: np.zeros(3, int), "shape"),
        (lambda s: np.zeros(24), "whole numbers"),
        (lambda s: np.full(24, 2), "0 to 1 expected"),
    ):
        with pytest.raises(InputError, match=words):
            apply_rule(rule, here)
    with pytest.raises(InputError, match="dgp has shape"):
        Situation(HOURS, 3, np.ones(24, bool), by_state={"dgp": np.zeros((2, 24))})
