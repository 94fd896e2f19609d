"""Calibration of rooms of known reflectances, whose light Radiance computed."""

import numpy as np
import pytest
from radiance import matrix, run
from scipy import stats

from clerestory.comparison.calibration_run import calibrate_study
from clerestory.comparison.series_comparison import Rules
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.study_tracing import study_skies
from uncertain_room import MATERIALS, scene_text, sensor_text, unknown, write_room

REPEATS, DEVIATION, NOISE = 20, 0.08, 0.05
SKY = """#@rfluxmtx h=u u=+Y
void glow ground 0 0 4 1 1 1 0
ground source below 0 0 4 0 0 -1 180
#@rfluxmtx h=r1 u=+Y
void glow sky 0 0 4 1 1 1 0
sky source above 0 0 4 0 0 1 180
"""


def coefficients(folder, reflectances):
    """Daylight coefficients of the sensors by rfluxmtx, over (sensor, patch)."""
    folder.mkdir()
    (folder / "room.rad").write_text(scene_text(reflectances))
    (folder / "sky.rad").write_text(SKY)
    run("oconv room.rad > room.oct", folder=folder)
    options = "-h -n 2 -I+ -ab 12 -ad 6000 -lw 1e-6 -faa"
    text = run(
        f"rfluxmtx {options} - sky.rad -i room.oct",
        folder=folder,
        stdin=sensor_text(),
    )
    return matrix(text)


def write_weather(file):
    """Write three days without sun, so that few rays suffice for every sensor."""
    head = "place cloudy\nlatitude 40\nlongitude 0\ntime_zone 0\nsite_elevation 0\n"
    lines = [
        f"6 {day} {hour + 0.5} 0 {60 + 15 * min(hour - 5, 19 - hour) + 10 * day}"
        for day in (20, 21, 22)
        for hour in range(5, 20)
    ]
    file.write_text(head + "weather_data_file_units 1\n" + "\n".join(lines) + "\n")


def sky_luminance(sky):
    """Luminance of each patch over time [cd/m²], of a sky in RGB."""
    weights = sky.bands.weights
    diffuse = (weights @ sky.colour)[:, None] * sky.diffuse
    return diffuse + (weights @ sky.sun_colour) * sky.sun.toarray()


def write_measured(file, times, lux):
    names = [f"desks.{k + 1}" for k in range(len(lux))]
    lines = [",".join(["time", *names])]
    for time, row in zip(times.astype("datetime64[m]").astype(str), lux.T, strict=True):
        lines.append(",".join([time, *(f"{value:.4f}" for value in row)]))
    file.write_text("\n".join(lines) + "\n")


@pytest.mark.slow
def test_true_reflectances_are_within_95_percent_in_19_of_20_rooms(tmp_path):
    """Reflectances are drawn from their priors; the light has an error of 5 %."""
    more = "[uncertainty]\n" + "".join(unknown(m, DEVIATION) for m in MATERIALS)
    write_weather(tmp_path / "cloudy.wea")
    text = 'file = "cloudy.wea"'
    file = write_room(tmp_path, more=more, samples=20_000, weather=text)
    study = read_study(file)
    inputs = read_inputs(study)
    luminance = sky_luminance(study_skies(study, inputs, None).whole)
    rng = np.random.default_rng(4)
    inside, joint, closer = [], [], 0
    for repeat in range(REPEATS):
        truth = {n: float(rng.normal(r, DEVIATION)) for n, r in MATERIALS.items()}
        C = coefficients(tmp_path / f"radiance{repeat}", truth)
        lux = C @ luminance
        noisy = lux * (1 + NOISE * rng.standard_normal(lux.shape))
        file = tmp_path / f"measured{repeat}.csv"
        write_measured(file, inputs.weather.times, noisy)
        found = calibrate_study(study, file, out=tmp_path / "out", rules=Rules(10.0))
        fit = found.calibration
        gap = fit.values - np.array(list(truth.values()))
        inside.append((np.abs(gap) < 1.96 * fit.deviations).tolist())
        joint.append(float(gap @ np.linalg.solve(fit.covariance, gap)))
        prior = sum(abs(truth[name] - rho) for name, rho in MATERIALS.items())
        closer += np.abs(gap).sum() < prior
    assert np.sum(np.array(joint) < stats.chi2(len(MATERIALS)).ppf(0.95)) >= 19
    assert np.mean(inside) >= 0.9
    assert closer >= 19
