"""A study run on matrices whose product is known, and run again."""

import json
import warnings

import numpy as np
import pytest
import xarray as xr

from clerestory.errors import ClerestoryWarning, InputError, OutputError
from clerestory.phases.matrix_store import MatrixStore
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.weather_formats import read_weather
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.results import read_results
from clerestory.study.study_run import run_study
from clerestory.study.study_tracing import trace_study

TRANSMITTANCE = 0.5  # of the diffuser in the study's window


def silent(_phase):
    return lambda _share, _note: None


def test_illuminance_is_that_of_the_closed_form(study_file, engine, tmp_path):
    """A diffuser sends on its share of the mean radiance of the sky, without ground."""
    results = run_study(read_study(study_file), out=tmp_path / "out")
    sky = sky_matrix(read_weather(study_file.with_name("two_days.wea")), subdivision=1)
    mean = sky.partition.dome.solid_angles() / (2 * np.pi)
    grey = 179 * np.array([0.265, 0.670, 0.065])
    radiance = np.einsum("c,p,cpt->t", grey, mean, sky.values[:, 1:].astype(float))
    for sensor in range(4):
        np.testing.assert_allclose(
            results.data["illuminance"][sensor],
            np.pi * TRANSMITTANCE * radiance,
            rtol=1e-5,
        )
    assert results.data["standard_error"].max() > 0
    assert engine.calls == ["view", "daylight"]


def test_results_say_where_sensors_windows_and_hours_are(study_file, engine, tmp_path):
    data = run_study(read_study(study_file), out=tmp_path).data
    assert data["sensor"].values.tolist() == ["desk.1", "desk.2", "desk.3", "eye.1"]
    assert data["grid"].values.tolist() == ["desk", "desk", "desk", "eye"]
    assert data["position"].values[3].tolist() == [2, 4.5, 1.2]
    assert data["direction"].values[3].tolist() == [0, -1, 0]
    assert int(data["occupied"].sum()) == 20
    assert data["window"].values.tolist() == ["south"]
    np.testing.assert_allclose(data["window_normal"].values, [[0, 1, 0]], atol=1e-9)
    np.testing.assert_allclose(data["window_up"].values, [[0, 0, 1]], atol=1e-9)
    np.testing.assert_allclose(data["window_centre"].values, [[2, 0, 1.75]], atol=1e-6)
    assert set(data["triangle_material"].values) == {"grey", "dark"}
    assert data.attrs["title"] == "Test room"
    assert data["illuminance"].dtype == np.float32


def test_saved_results_read_back_the_same(study_file, engine, tmp_path):
    results = run_study(read_study(study_file), out=tmp_path)
    again = read_results(tmp_path)
    xr.testing.assert_identical(again.data.drop_attrs(), results.data.drop_attrs())
    assert again.run == json.loads((tmp_path / "run.json").read_text())
    assert again.title == "Test room"
    assert again.grids() == ["desk", "eye"]


def test_running_twice_writes_the_same_bytes_and_traces_once(
    study_file, engine, tmp_path
):
    study = read_study(study_file)
    run_study(study, out=tmp_path / "one")
    first = (tmp_path / "one" / "results.nc").read_bytes()
    run_study(study, out=tmp_path / "one")
    run_study(study, out=tmp_path / "two")
    assert engine.calls == ["view", "daylight"] * 2
    for folder in ("one", "two"):
        assert (tmp_path / folder / "results.nc").read_bytes() == first
    found = json.loads((tmp_path / "one" / "run.json").read_text())["matrices"]
    assert [matrix["found"] for matrix in found.values()] == [True, True]


def test_another_weather_is_not_traced_again(study_file, engine, tmp_path):
    run_study(read_study(study_file), out=tmp_path)
    weather = study_file.with_name("two_days.wea")
    weather.write_text(weather.read_text().replace("latitude 51.5", "latitude 48.0"))
    run_study(read_study(study_file), out=tmp_path)
    assert engine.calls == ["view", "daylight"]


@pytest.mark.parametrize(
    ("name", "old", "new", "traced"),
    [
        ("room.rad", "0.5 0.5 0.5", "0.5 0.5 0.4", ["view", "daylight"]),
        ("room.rad", "# A room", "\n\n# A room", []),
        ("desk.pts", "0.75", "0.76", ["view"]),
        ("window.rad", "0 2.5", "0 2.4", ["view", "daylight"]),
        ("window.rad", "u=Z", "u=X", ["view", "daylight"]),
        ("study.toml", "seed = 7", "seed = 8", ["view", "daylight"]),
        ("study.toml", "samples = 256", "samples = 512", ["view", "daylight"]),
        ("study.toml", "seed = 7", "seed = 7\nbounces = 3", ["view", "daylight"]),
        ("study.toml", "subdivision = 1", "subdivision = 2", ["daylight"]),
        ("study.toml", "subdivision = 1", "rotation_deg = 9\nsubdivision = 1", []),
    ],
)
def test_what_changed_is_traced_again_and_nothing_else(
    study_file, engine, tmp_path, name, old, new, traced
):
    def trace():
        study = read_study(study_file)
        store = MatrixStore(tmp_path / "matrices")
        return trace_study(Job(study, read_inputs(study), store, silent))

    trace()
    engine.calls.clear()
    path = study_file.with_name(name)
    text = path.read_text()
    assert old in text
    path.write_text(text.replace(old, new))
    trace()
    assert engine.calls == traced


def test_a_run_killed_between_two_matrices_goes_on_after_the_first(
    study_file, engine, tmp_path, monkeypatch
):
    study = read_study(study_file)
    run_study(study, out=tmp_path / "whole")

    def killed(*_arguments, **_options):
        raise KeyboardInterrupt

    with monkeypatch.context() as patch:
        patch.setattr("clerestory.study.study_tracing.daylight_matrix", killed)
        with pytest.raises(KeyboardInterrupt):
            run_study(study, out=tmp_path / "killed")
    assert not (tmp_path / "killed" / "results.nc").exists()
    engine.calls.clear()
    run_study(study, out=tmp_path / "killed")
    assert engine.calls == ["daylight"]
    one, other = (tmp_path / name / "results.nc" for name in ("whole", "killed"))
    assert one.read_bytes() == other.read_bytes()


def test_two_phase_needs_no_window(study_file, engine, tmp_path):
    text = study_file.read_text().replace("3-phase", "2-phase")
    start, end = text.index("[[window]]"), text.index("[[sensors]]")
    study_file.write_text(text[:start] + text[end:])
    data = run_study(read_study(study_file), out=tmp_path).data
    assert engine.calls == ["coefficients", "sun"]
    assert "window" not in data
    assert read_results(tmp_path).data.attrs["method"] == "2-phase"
    noon = int(data["illuminance"].sum("sensor").argmax("time"))
    assert data["illuminance"][0, noon] > 1000


def test_part_of_the_year_can_be_chosen(study_file, engine, tmp_path):
    text = study_file.read_text()
    weather = 'file = "two_days.wea"'
    study_file.write_text(text.replace(weather, weather + '\nfrom = "06-21"'))
    data = run_study(read_study(study_file), out=tmp_path).data
    assert data.sizes["time"] == 24
    study_file.write_text(text.replace(weather, weather + '\nfrom = "08-01"'))
    with pytest.raises(InputError, match="no weather from 08-01 to 12-31"):
        run_study(read_study(study_file), out=tmp_path)


def test_a_schedule_without_a_time_step_is_reported_before_tracing(study_file, engine):
    text = study_file.read_text()
    hours = "[schedule]\nfrom_hour = 8.1\nto_hour = 8.4\n[trace]"
    study_file.write_text(text.replace("[trace]", hours))
    with pytest.raises(InputError, match=r"no time step lies between 8\.1 and 8\.4 h"):
        read_inputs(read_study(study_file))


def test_several_windows_in_one_file_get_names_of_their_own(study_file):
    path = study_file.with_name("window.rad")
    pane = path.read_text().replace("void polygon pane", "left polygon pane")
    other = pane.replace("left polygon pane", "right polygon pane")
    path.write_text(pane + other)
    groups = read_inputs(read_study(study_file)).groups
    assert [group.name for group in groups] == ["south.left", "south.right"]


def test_the_basis_of_the_bsdf_takes_precedence_and_is_reported(study_file):
    path = study_file.with_name("window.rad")
    path.write_text(path.read_text().replace("h=kq", "h=kf"))
    with pytest.warns(ClerestoryWarning, match="41 patches .* 145"):
        group = read_inputs(read_study(study_file)).groups[0]
    assert len(group.inner.partition) == 41
    assert group.states[0].transmission.rows.window == "south"


def test_doubts_about_the_scene_are_warned_of_and_noted(study_file, engine, tmp_path):
    path = study_file.with_name("desk.pts")
    path.write_text("1.5 1.5 -5 0 0 1\n")
    with pytest.warns(ClerestoryWarning, match=r"desk\.1"):
        results = run_study(read_study(study_file), out=tmp_path)
    assert any("desk.1" in text for text in results.run["warnings"])


def test_a_folder_that_cannot_be_written_is_reported(study_file, engine, tmp_path):
    (tmp_path / "file").write_text("")
    with pytest.raises(OutputError, match="cannot be made"):
        run_study(read_study(study_file), out=tmp_path / "file" / "out")
    assert engine.calls == []


def test_an_unwritable_file_leaves_the_old_results(study_file, engine, tmp_path):
    (tmp_path / "metrics.csv").mkdir()
    with pytest.raises(OutputError, match=r"metrics\.csv"):
        run_study(read_study(study_file), out=tmp_path)
    assert not (tmp_path / "results.nc").exists()
    assert not [path for path in tmp_path.iterdir() if path.name.startswith(".")]


def test_a_display_is_started_for_each_traced_phase(study_file, engine, tmp_path):
    shown = []

    def display(phase):
        return lambda share, note: shown.append((phase, share, note))

    run_study(read_study(study_file), out=tmp_path, display=display)
    assert [phase for phase, _, _ in shown] == [
        "view matrices",
        "daylight matrix of south",
        "multiply",
    ]


def test_times_and_versions_go_to_run_json_alone(study_file, engine, tmp_path):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        results = run_study(read_study(study_file), out=tmp_path)
    facts = results.run
    assert set(facts["seconds"]) >= {"read", "trace", "sky", "multiply"}
    assert facts["versions"]["clerestory"]
    assert facts["seed"] == 7
    assert 0 < facts["median_relative_error_of_mean"]["desk"] < 1
