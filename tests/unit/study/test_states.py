"""Shades with states in studies: what each rule chooses, and what is traced for it.

The sensors see nothing but the window and the window nothing but the sky, so every
illuminance is π times the transmittance of the state times the sky's mean radiance.
"""

import json

import numpy as np
import pytest

from clerestory.control.profile_angle import profile_angle
from clerestory.errors import InputError
from clerestory.sky.sky_conditions import sun_over
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather
from clerestory.study.config import read_study
from clerestory.study.illuminance_by_state import operated_illuminance
from clerestory.study.inputs import read_inputs
from clerestory.study.study_run import run_study
from sample_files import STATES, write_states

TAUS = (0.6, 0.2, 0.05)
GREY = 179 * np.array([0.265, 0.670, 0.065])


@pytest.fixture
def shaded(study_file, engine):
    """The study with three states in its window; returns a way to give it a rule."""
    write_states(study_file.parent, TAUS)
    plain = study_file.read_text()

    def with_rule(rule, extra=""):
        control = f"[window.control]\n{rule}\n" if rule else ""
        text = plain.replace('bsdf = "diffuser.xml"\n', STATES + control)
        study_file.write_text(text + extra)
        return study_file

    return with_rule


def run(file, out):
    return run_study(read_study(file), out=out).data


def mean_radiance(file, **options):
    """Mean radiance of the dome over time, as luminance [cd/m²]."""
    weather = read_weather(file.with_name("two_days.wea"))
    sky = sky_matrix(weather, subdivision=1, **options)
    mean = sky.partition.dome.solid_angles() / (2 * np.pi)
    return np.einsum("c,p,cpt->t", GREY, mean, sky.values[:, 1:].astype(float))


def chosen(data):
    return data["state"].values[0].astype(int)


def test_illuminance_is_that_of_the_state_that_acts(shaded, tmp_path):
    file = shaded('rule = "threshold"\nquantity = "direct normal"\nclose_above = 200')
    data = run(file, tmp_path)
    sunny = read_weather(file.with_name("two_days.wea")).direct_normal > 200
    assert 0 < sunny.sum() < len(sunny)
    assert chosen(data).tolist() == np.where(sunny, 2, 0).tolist()
    expected = np.pi * np.take(TAUS, chosen(data)) * mean_radiance(file)
    np.testing.assert_allclose(data["illuminance"][0], expected, rtol=1e-4)
    assert data["state"].dtype == np.int8
    assert data["state_name"].values.tolist() == [["open", "half", "closed"]]
    assert data["control"].values.tolist() == ["threshold"]
    assert data["standard_error"].max() > 0


def test_without_a_rule_the_first_state_stays(shaded, tmp_path):
    data = run(shaded(""), tmp_path)
    assert chosen(data).max() == 0
    assert data["control"].values.tolist() == ["fixed"]


@pytest.mark.parametrize("state", ['"half"', "1"])
def test_a_state_can_be_fixed_by_number_or_name(shaded, tmp_path, state):
    data = run(shaded(f'rule = "fixed"\nstate = {state}'), tmp_path)
    assert set(chosen(data).tolist()) == {1}


@pytest.mark.parametrize("memory_gb", [8, 1e-4])
def test_illuminance_by_state_is_that_of_each_state(shaded, tmp_path, memory_gb):
    """With `by_state`, in memory and with view matrices and hours in files."""
    file = shaded('rule = "threshold"\nquantity = "direct normal"\nclose_above = 200')
    text = file.read_text().replace("[output]", "[output]\nby_state = true")
    file.write_text(text.replace("[trace]", f"[trace]\nmemory_gb = {memory_gb}"))
    data = run(file, tmp_path)
    parts = data["illuminance_by_state"]
    assert parts.dims == ("sensor", "window", "state_number", "time")
    for state, tau in enumerate(TAUS):
        expected = np.pi * tau * mean_radiance(file)
        np.testing.assert_allclose(parts[0, 0, state], expected, rtol=1e-4)
    found = operated_illuminance(parts, list(data["state"].values.astype(int)))
    # Both are single-precision sums over 41 patches, in an order of their own: each
    # is rounded by at most 41 times half an epsilon
    rounding = 41 * np.finfo(np.float32).eps
    np.testing.assert_allclose(found, data["illuminance"], rtol=rounding)


def test_by_state_needs_a_window_with_several_states(study_file):
    text = study_file.read_text()
    study_file.write_text(text.replace("[output]", "[output]\nby_state = true"))
    with pytest.raises(InputError, match=r"several states; tables \[\[window.state"):
        read_study(study_file)


def test_outside_the_schedule_another_state_holds(shaded, tmp_path):
    data = run(shaded('rule = "fixed"\nstate = 0\nwhen_empty = "closed"'), tmp_path)
    expected = np.where(data["occupied"].values, 0, 2)
    assert chosen(data).tolist() == expected.tolist()


def test_another_rule_traces_nothing_again(shaded, engine, tmp_path):
    """V once, D once for all states; rules only choose."""
    for rule in (
        'rule = "fixed"\nstate = 2',
        'rule = "threshold"\nclose_above = 100',
        'rule = "best"\ngrid = "desk"',
        "",
    ):
        run(shaded(rule), tmp_path)
        assert engine.calls == ["view", "daylight"]
    found = json.loads((tmp_path / "run.json").read_text())["matrices"]
    assert all(matrix["found"] for matrix in found.values())


def test_stages_of_facade_illuminance_follow_the_sky(shaded, tmp_path):
    """A façade that sees the whole dome alike gets π times its mean luminance."""
    rule = 'rule = "threshold"\nquantity = "facade illuminance"\n'
    file = shaded(rule + "close_above = [5000, 20000]")
    lux = np.pi * mean_radiance(file)
    data = run(file, tmp_path)
    stages = (lux > 5000).astype(int) + (lux > 20000)
    assert set(stages) == {0, 1, 2}
    assert chosen(data).tolist() == stages.tolist()


def test_facade_irradiance_is_that_of_the_solar_sky(shaded, tmp_path):
    file = shaded("")
    data = run(file, tmp_path)
    solar = mean_radiance(file, spectrum="solar") / 179
    np.testing.assert_allclose(data["facade_irradiance"][0], np.pi * solar, rtol=1e-4)


def test_a_shade_moves_after_a_delay(shaded, tmp_path):
    """Two hours above the threshold on hourly steps: it closes at the second one."""
    rule = 'rule = "threshold"\nquantity = "diffuse horizontal"\nclose_above = 100\n'
    data = run(shaded(rule + "close_after = 120\nopen_after = 60"), tmp_path)
    at_once = run(shaded(rule), tmp_path)
    first = int(np.argmax(chosen(at_once)))
    assert int(np.argmax(chosen(data))) == first + 1


def test_the_profile_angle_chooses_the_tilt(shaded, tmp_path):
    file = shaded('rule = "profile angle"\nangles_deg = [75, 65]\nsun_above = 1')
    data = run(file, tmp_path)
    weather = read_weather(file.with_name("two_days.wea"))
    frame = read_inputs(read_study(file)).groups[0].inner.frame
    directions = sun_over(weather).directions()
    angle = np.degrees(profile_angle(directions, frame))
    on_facade = weather.direct_normal * -(directions @ frame.normal)
    sunny = (directions[:, 2] > 0) & (on_facade > 1)
    below = (angle < 75).astype(int) + (angle < 65)
    assert set(below[sunny]) == {0, 1, 2}
    assert chosen(data).tolist() == np.where(sunny, below, 0).tolist()


def test_slats_stop_the_sun_as_open_as_they_can(shaded, tmp_path):
    """Slats twice as far apart as they are wide stop ψ with sin(β + ψ) ≥ 2 cos ψ.

    That is tan ψ ≥ 2, 63.4°, for level slats and tan ψ ≥ √3, 60°, for a tilt of 30°.
    """
    rule = 'rule = "cut-off"\ntilts_deg = [0, 30, 80]\nslat_width = 0.08\n'
    file = shaded(rule + "slat_spacing = 0.16\nsun_above = 1")
    data = run(file, tmp_path)
    angle = np.degrees(data["profile_angle"].values[0])
    sunny = read_weather(file.with_name("two_days.wea")).direct_normal > 0
    steps = (angle > 60) & (angle < 63.4) & sunny
    assert steps.any()
    assert set(chosen(data)[steps]) == {1}
    assert set(chosen(data)[~(angle < 63.5)]) == {0}


def test_raised_slats_act_when_there_is_no_sun_to_block(shaded, tmp_path):
    """Level slats of the width of their spacing stop ψ ≥ 45°, a tilt of 60° the rest.

    They are raised while there is no sun on the façade.
    """
    rule = 'rule = "cut-off"\ntilts_deg = ["raised", 0, 60]\nslat_width = 0.08\n'
    file = shaded(rule + "slat_spacing = 0.08\nsun_above = 1")
    data = run(file, tmp_path)
    angle = np.degrees(data["profile_angle"].values[0])
    sunny = read_weather(file.with_name("two_days.wea")).direct_normal > 0
    sunny &= np.isfinite(angle)
    expected = np.where(sunny, np.where(angle >= 45, 1, 2), 0)
    assert {0, 1} <= set(expected)
    assert chosen(data).tolist() == expected.tolist()


def test_simplified_glare_keeps_its_limit(shaded, tmp_path):
    """DGPs = 6.22e-5 Ev + 0.184 of the eye's illuminance, least closed below 0.35."""
    file = shaded('rule = "glare"\ngrid = "eye"\ndgp_below = 0.35')
    data = run(file, tmp_path)
    lux = np.pi * np.outer(TAUS, mean_radiance(file))
    good = 6.22e-5 * lux + 0.184 <= 0.35
    expected = np.where(good.any(axis=0), good.argmax(axis=0), 2)
    assert len(set(expected)) > 1
    assert chosen(data).tolist() == expected.tolist()


def test_the_best_state_gives_light_without_too_much(shaded, tmp_path):
    rule = 'rule = "best"\ngrid = "desk"\ntarget_lux = 500\nlux_below = 3000'
    file = shaded(rule)
    lux = np.pi * np.outer(TAUS, mean_radiance(file))
    score = np.where(lux <= 3000, np.minimum(lux, 500), -1)
    expected = np.where((lux <= 3000).any(axis=0), score.argmax(axis=0), 2)
    assert len(set(expected)) > 1
    assert chosen(run(file, tmp_path)).tolist() == expected.tolist()


def test_blinds_of_lm83_close_where_the_sun_comes_in(shaded, engine, tmp_path):
    """Direct light spread by the diffuser: π τ times the sun's mean radiance."""
    file = shaded('rule = "LM-83"\ngrid = "desk"')
    data = run(file, tmp_path)
    sun = np.pi * np.outer(TAUS, mean_radiance(file, include="sun"))
    good = sun < 1000
    expected = np.where(good.any(axis=0), good.argmax(axis=0), 2)
    assert len(set(expected)) > 1
    assert chosen(data).tolist() == expected.tolist()
    assert data["rule_kept"].values.tolist() == good.any(axis=0).tolist()
    np.testing.assert_allclose(data["direct_open"][0], sun[0], rtol=1e-4)
    assert engine.calls == ["view", "daylight"] * 2


def test_states_of_a_run_are_a_schedule_for_the_next(shaded, tmp_path):
    first = run(shaded('rule = "threshold"\nclose_above = [50, 300]'), tmp_path / "a")
    file = shaded('rule = "schedule"\nfile = "states.csv"'.replace("states", "copy"))
    file.with_name("copy.csv").write_text((tmp_path / "a" / "states.csv").read_text())
    second = run(file, tmp_path / "b")
    assert chosen(second).tolist() == chosen(first).tolist()
    np.testing.assert_array_equal(second["illuminance"], first["illuminance"])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("time,north\n2023-01-01T00:00,0\n", 'no column "south"'),
        ("time,south\n2023-01-01T00:00,3\n", "is 3; a number from 0 to 2 expected"),
        ("time,south\n", "no lines after the header"),
    ],
)
def test_a_wrong_schedule_is_reported(shaded, tmp_path, text, words):
    file = shaded("")
    file.with_name("copy.csv").write_text(text)
    with pytest.raises(InputError, match=words):
        run(shaded('rule = "schedule"\nfile = "copy.csv"'), tmp_path)


OWN_RULE = """
def shade(s):
    assert s.states == 3
    return (s.by_state["illuminance desk"][0] > 4000) * 2 * s.occupied
"""


def test_a_function_of_ones_own_chooses(shaded, tmp_path):
    file = shaded('rule = "python"\nfunction = "own.py:shade"\nneeds = ["illuminance"]')
    file.with_name("own.py").write_text(OWN_RULE)
    data = run(file, tmp_path)
    dark = np.pi * TAUS[0] * mean_radiance(file) > 4000
    expected = np.where(dark & data["occupied"].values, 2, 0)
    assert len(set(expected)) == 2
    assert chosen(data).tolist() == expected.tolist()


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("def shade(s):\n    return s.nothing", "ended with AttributeError"),
        ("def shade(s):\n    return s.signals['irradiance']", "whole numbers expected"),
        ("def other(s):\n    return 0", 'no function "shade"'),
        ("def shade(s)", "SyntaxError"),
        ("1 / 0", "ZeroDivisionError"),
    ],
)
def test_a_function_that_fails_is_reported_in_one_line(shaded, tmp_path, text, words):
    file = shaded('rule = "python"\nfunction = "own.py:shade"')
    file.with_name("own.py").write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        run(file, tmp_path)
    assert "\n" not in str(caught.value)


def test_a_killed_run_with_states_goes_on_to_the_same_bytes(
    shaded, engine, tmp_path, monkeypatch
):
    study = read_study(shaded('rule = "LM-83"'))
    run_study(study, out=tmp_path / "whole")

    def killed(*_arguments, **_options):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("clerestory.study.study_tracing.daylight_matrix", killed)
        with pytest.raises(KeyboardInterrupt):
            run_study(study, out=tmp_path / "killed")
    engine.calls.clear()
    run_study(study, out=tmp_path / "killed")
    assert engine.calls == ["daylight", "view", "daylight"]
    one, other = (tmp_path / name / "results.nc" for name in ("whole", "killed"))
    assert one.read_bytes() == other.read_bytes()


def test_two_phases_have_states_too(shaded, engine, tmp_path):
    """One trace for each state, of all light and of direct light."""
    file = shaded('rule = "fixed"\nstate = 1')
    file.write_text(file.read_text().replace("3-phase", "2-phase"))
    data = run(file, tmp_path)
    assert engine.calls == ["coefficients"] * 3
    assert set(chosen(data).tolist()) == {1}
    run(file, tmp_path)
    assert engine.calls == ["coefficients"] * 3


def test_methods_are_compared_with_the_same_shades(shaded, engine, tmp_path):
    file = shaded('rule = "threshold"\nclose_above = 100')
    both = 'method = ["2-phase", "3-phase"]'
    file.write_text(file.read_text().replace('method = "3-phase"', both))
    data = run(file, tmp_path)
    assert data["method"].values.tolist() == ["2-phase", "3-phase"]
    last = data["illuminance_by_method"].sel({"method": "3-phase"})
    np.testing.assert_array_equal(last, data["illuminance"])
    lines = (tmp_path / "comparison.csv").read_text().splitlines()
    assert lines[0].startswith("method,grid,mean [lux],mean bias [%]")
    assert [line.split(",")[:2] for line in lines[1:]] == [
        ["2-phase", "desk"],
        ["2-phase", "eye"],
        ["3-phase", "desk"],
        ["3-phase", "eye"],
    ]
    assert ",0,0,100,100,100," in lines[3]
    for method in ("2-phase", "3-phase"):
        states = (tmp_path / method / "states.csv").read_bytes()
        assert states == (tmp_path / "states.csv").read_bytes()


WRONG_RULES = {
    "rule that is none": ('rule = "magic"', '"fixed", "cut-off"'),
    "key of another rule": (
        'rule = "fixed"\nstate = 1\nclose_above = 5',
        'rule "fixed" has no key "close_above"; one of state expected',
    ),
    "key that is missing": ('rule = "threshold"', 'without "close_above"'),
    "state that is none": ('rule = "fixed"\nstate = "shut"', "no state 'shut'"),
    "state beyond the last": ('rule = "fixed"\nstate = 3', "a number below 3"),
    "too few tilts": (
        'rule = "cut-off"\ntilts_deg = [0, 45]\nslat_width = 1\nslat_spacing = 1',
        '"tilts_deg" has 2 numbers; 3 expected for 3 states',
    ),
    "tilt of 400°": (
        'rule = "cut-off"\ntilts_deg = [0, 45, 400]\nslat_width = 1\nslat_spacing = 1',
        "window[1].control.tilts_deg is [0, 45, 400]; tilts from -90 to 90",
    ),
    "tilt that is none": (
        'rule = "cut-off"\ntilts_deg = [nan, 45, 60]\nslat_width = 1\nslat_spacing = 1',
        "tilts from -90 to 90",
    ),
    "raised later": (
        'rule = "cut-off"\ntilts_deg = [0, "raised", 45]\nslat_width = 1\n'
        "slat_spacing = 1",
        'optionally after "raised"',
    ),
    "raised counted as level slats": (
        'rule = "cut-off"\ntilts_deg = [0, 0, 45]\nslat_width = 1\nslat_spacing = 1',
        "state 1 does not), expected",
    ),
    "closed before open": (
        'rule = "cut-off"\ntilts_deg = [90, 0, 45]\nslat_width = 1\nslat_spacing = 0.9',
        "state 1 does not), expected",
    ),
    "angle of 400°": (
        'rule = "profile angle"\nangles_deg = [400, 40]',
        "angles_deg[1] is 400; a number of at most 90",
    ),
    "angles that rise": (
        'rule = "profile angle"\nangles_deg = [20, 40]',
        "each angle below the one before expected",
    ),
    "thresholds that fall": (
        'rule = "threshold"\nclose_above = [300, 200]',
        "numbers in rising order expected",
    ),
    "threshold of text": ('rule = "threshold"\nclose_above = "x"', "a number, or a li"),
    "opens above": (
        'rule = "threshold"\nclose_above = 200\nopen_below = 300',
        'does not match "close_above"',
    ),
    "no such grid": (
        'rule = "best"\ngrid = "roof"',
        'of window "south" refers to grid "roof"; one of desk',
    ),
    "glare without a view": (
        'rule = "glare"',
        'of window "south" depends on glare, but there is no',
    ),
    "function without a file": (
        'rule = "python"\nfunction = "shade"',
        '"FILE.py:FUNCTION" expected',
    ),
}


@pytest.mark.parametrize("case", WRONG_RULES)
def test_a_wrong_rule_is_reported_with_its_line(shaded, case):
    rule, words = WRONG_RULES[case]
    with pytest.raises(InputError) as caught:
        read_study(shaded(rule))
    assert words in str(caught.value)
    if "of window" not in words:
        assert caught.value.line
