"""Studies with states and luminaires, traced: glare rules, methods, electric light."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.study.config import read_study
from clerestory.study.results import read_results
from clerestory.study.study_run import run_study
from sample_files import STATES, write_states

ROOM = Path(__file__).parents[1] / "cli" / "room"
TAUS = (0.6, 0.15, 0.02)

# 1000 cd straight down, I(θ) = 1000 cos θ cd; a flat disc of 20 cm; 40 W
DISC = """IESNA:LM-63-2002
TILT=NONE
1 -1 1 7 1 1 2 -.2 -.2 0
1 1 40
0 15 30 45 60 75 90
0
1000 965.926 866.025 707.107 500 258.819 0
"""

SUNS = "\n[sun]\npicture_samples = 2\n"

VIEW = """
[[view]]
file = "seat.vf"
resolution = 144
samples = 8
"""


@pytest.fixture
def study(tmp_path):
    """The room of ten polygons with three states; returns what writes a study."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    write_states(folder, TAUS)
    (folder / "disc.ies").write_text(DISC)
    (folder / "seat.vf").write_text(
        "rvu -vta -vp 2 2 1.2 -vd 0 -1 0 -vu 0 0 1 -vh 180 -vv 180\n"
    )
    plain = (folder / "study.toml").read_text()
    weather = 'file = "two_days.wea"'

    def written(*, method='"3-phase"', control="", more="", hours="", samples=256):
        rule = f"[window.control]\n{control}\n" if control else ""
        text = plain.replace('bsdf = "diffuser.xml"\n', STATES + rule)
        text = text.replace('method = "3-phase"', f"method = {method}")
        text = text.replace(weather, f'{weather}\nfrom = "06-21"\n{hours}')
        text = text.replace("samples = 256", f"samples = {samples}")
        (folder / "study.toml").write_text(text + more)
        return read_study(folder / "study.toml")

    return written


NOON = "from_hour = 6\nto_hour = 20"


@pytest.mark.parametrize("method", ['"3-phase"', '"5-phase"'])
def test_glare_chooses_the_least_closed_state(study, tmp_path, method):
    """Its choice against runs in which each state is fixed; nothing traced again."""
    glare = []
    for state in range(3):
        fixed = study(
            method=method, control=f'rule = "fixed"\nstate = {state}',
            more=VIEW + SUNS, hours=NOON,
        )  # fmt: skip
        data = run_study(fixed, out=tmp_path / "out").data
        glare.append(data["glare_dgp"].values[0])
    dgp = np.stack(glare)
    limit = float(np.median(dgp[1]))
    rule = f'rule = "glare"\ndgp_below = {limit!r}'
    study(method=method, control=rule, more=VIEW + SUNS, hours=NOON)
    file = tmp_path / "study" / "study.toml"
    file.write_text(file.read_text().replace("[output]", "[output]\nby_state = true"))
    results = run_study(read_study(file), out=tmp_path / "out")
    by_state = results.data["glare_dgp_by_state"].transpose("view", "shade_state", ...)
    np.testing.assert_allclose(by_state[0], dgp, rtol=1e-6)
    good = dgp <= limit + 1e-9
    expected = np.where(good.any(axis=0), good.argmax(axis=0), dgp.argmin(axis=0))
    state = results.data["state"].values[0].astype(int)
    assert state.tolist() == expected.tolist()
    assert len(set(expected.tolist())) > 1
    acts = np.take_along_axis(dgp, expected[None], axis=0)[0]
    np.testing.assert_allclose(results.data["glare_dgp"][0], acts, rtol=1e-6)
    assert all(matrix["found"] for matrix in results.run["matrices"].values())


def test_methods_agree_behind_a_diffuser(study, tmp_path):
    """A Lambertian pane that reflects nothing: two and three phases are the same.

    Paths of the two-phase method find the sun's patches by chance, hence their number.
    Nothing shades a part of the window: three phases know its mean irradiance only.
    """
    room = tmp_path / "study" / "room.rad"
    before, _, behind = room.read_text().partition("grey polygon overhang")
    room.write_text(before + "dark polygon ground" + behind.split("polygon ground")[1])
    compared = study(
        method='["2-phase", "3-phase"]',
        control='rule = "fixed"\nstate = 1',
        hours=NOON,
        samples=1 << 17,
    )
    run_study(compared, out=tmp_path / "out")
    two, three = (
        read_results(tmp_path / "out" / method).data.isel(sensor=slice(3))
        for method in ("2-phase", "3-phase")
    )
    # All steps share their paths, so the day's errors add up as they are
    off = (two["illuminance"] - three["illuminance"]).sum("time").values
    error = np.hypot(two["standard_error"], three["standard_error"])
    assert np.all(np.abs(off) < 4 * error.sum("time").values)
    assert error.values.mean() < 0.06 * three["illuminance"].values.mean()


LAMPS = """
[[luminaire]]
file = "disc.ies"
places = [[2, 2.5, 2.9]]
[[lighting]]
grid = "desk"
control = "{control}"
setpoint_lux = {setpoint}
least_output = 0
least_power = 0
standby = 2
"""


def test_lamps_give_what_daylight_lacks(study, tmp_path):
    """Behind closed blinds: output = (setpoint − daylight)/full; power follows."""
    lamps = LAMPS.format(control="dimming", setpoint=150)
    made = study(control='rule = "fixed"\nstate = 2', more=lamps, samples=4096)
    data = run_study(made, out=tmp_path / "out").data
    desk = (data["grid"] == "desk").values
    daylight = data["illuminance"].values[desk].mean(axis=0)
    electric = data["electric_illuminance"].values[desk].mean(axis=0)
    output, power = data["dimming"].values[0], data["lighting_power"].values[0]
    hours = data["occupied"].values
    partly = hours & (output > 0) & (output < 1)
    assert partly.any()
    np.testing.assert_allclose((daylight + electric)[partly], 150, rtol=1e-4)
    np.testing.assert_allclose(
        power[hours & (output > 0)], 40 * output[hours & (output > 0)], rtol=1e-5
    )
    assert np.all(power[~hours] == 2)
    assert np.all(output[hours & (daylight >= 150)] == 0)
    assert data["lighting_energy"].item() == pytest.approx(power.sum(), rel=1e-5)
    lines = (tmp_path / "out" / "lighting.csv").read_text().splitlines()
    assert len(lines) == 1 + data.sizes["time"]


def test_a_lamp_lights_as_far_as_the_inverse_square_says(study, tmp_path):
    """E = I cos θ/d² with I = 1000 cos θ, in a black room; pictures have it too."""
    made = study(
        control='rule = "fixed"\nstate = 2',
        more=VIEW + LAMPS.format(control="none", setpoint=500),
        samples=4096,
    )
    room = tmp_path / "study" / "room.rad"
    room.write_text(
        room.read_text()
        .replace("0.5 0.5 0.5 0 0", "0 0 0 0 0")
        .replace("0.2 0.2 0.2 0 0", "0 0 0 0 0")
    )
    data = run_study(made, out=tmp_path / "out").data
    on = np.flatnonzero(data["occupied"].values)[0]
    for sensor in range(3):
        away = data["position"].values[sensor] - [2, 2.5, 2.9]
        distance = np.linalg.norm(away)
        expected = 1000 * (-away[2] / distance) ** 2 / distance**2
        found = float(data["electric_illuminance"][sensor, on])
        assert found == pytest.approx(expected, rel=0.01)
    night = data["illuminance"].values.max(axis=0) == 0
    glare = data["glare_illuminance"].values[0]
    lit = data["dimming"].values[0] > 0
    assert np.all(np.isnan(glare[night & ~lit]))
    assert np.all(glare[lit] > 0)


def test_pictures_of_every_step_are_written_and_narrow_views_not_evaluated(
    study, tmp_path
):
    """A perspective view has pictures and no glare."""
    (tmp_path / "study" / "door.vf").write_text(
        "rvu -vtv -vp 2 4.5 1.6 -vd 0 -1 0 -vu 0 0 1 -vh 60 -vv 45\n"
    )
    more = VIEW.replace("seat.vf", "door.vf") + 'pictures = "every"\n' + VIEW
    made = study(control='rule = "fixed"\nstate = 0', more=more, hours=NOON)
    data = run_study(made, out=tmp_path / "out").data
    assert data["view"].values.tolist() == ["seat"]
    lit = data["time"].values[np.isfinite(data["glare_dgp"].values[0])]
    expected = [f"door_{str(t)[5:16].replace(':', '')}.hdr" for t in lit]
    found = sorted(path.name for path in (tmp_path / "out" / "pictures").iterdir())
    assert found == expected
