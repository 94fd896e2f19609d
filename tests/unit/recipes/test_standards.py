"""LEED, BREEAM and EN 17037 of recipes: shares and hours that are known exactly."""

import json
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest
from honeybee_models import honeybee_model, office

from clerestory.metrics.honeybee import STATIC, read_honeybee
from clerestory.recipes.annual import AnnualLight, _lit, _with_paths
from clerestory.recipes.breeam_credits import write_credits
from clerestory.recipes.en17037_levels import write_levels
from clerestory.recipes.leed_credits import write_points
from clerestory.recipes.model import read_model
from clerestory.recipes.outputs import write_illuminance

HOURS = np.arange(8760)
TIMES = np.datetime64("2023-01-01T00:30", "s") + HOURS * np.timedelta64(3600, "s")
SUN_UP = np.ones(len(TIMES), dtype=bool)
OCCUPIED = (HOURS % 24 >= 8) & (HOURS % 24 < 18)


def grid(name, count, spacing):
    places = [[0.5 + spacing * k, y, 0.8] for k in range(count // 2) for y in (1, 1.5)]
    sensors = [{"pos": place, "dir": [0, 0, 1]} for place in places]
    return {"identifier": name, "sensors": sensors}


@pytest.fixture
def chosen(tmp_path):
    """Grids "a" of 8 sensors of 0.25 m², and "b" of 4 sensors of 0.5 m²."""
    grids = [grid("a", 8, 0.5), grid("b", 4, 1.0)]
    # Not beside results, where the postprocessing package looks for models
    path = tmp_path / "inputs" / "model.hbjson"
    path.parent.mkdir()
    path.write_text(json.dumps(honeybee_model(office(), sensor_grids=grids)))
    return read_model(path)


def light_of(chosen, total, direct=None):
    """Annual light; each is a list of arrays over the states, by grid."""
    states = [
        {"total": lux, "direct": sun}
        for lux, sun in zip(total, direct or total, strict=True)
    ]
    if len(states) == 1:
        return AnnualLight(
            chosen.grids, TIMES, 1, {STATIC: {"default": states[0]}}, SUN_UP
        )
    names = {f"{k}_state": each for k, each in enumerate(states)}
    grids = tuple(replace(each, light_paths=("south",)) for each in chosen.grids)
    return AnnualLight(grids, TIMES, 1, {"south": names}, SUN_UP)


def saved(folder, name):
    return json.loads((folder / f"{name}.json").read_text())


def test_the_area_of_a_sensor_is_that_of_its_cell(chosen):
    assert chosen.cell_areas() == pytest.approx({"a": 0.25, "b": 0.5})


def test_levels_follow_from_the_area_with_light_in_half_of_the_daylight_hours(
    chosen, tmp_path
):
    """Of "a" all sensors have 300 lux and half of them 500; of "b" all have 99 lux."""
    daylight = np.arange(8760) % 2 == 0
    enough = daylight & (HOURS % 4 == 0)
    lux = {name: np.zeros((count, 8760)) for name, count in (("a", 8), ("b", 4))}
    lux["a"] += 300 * enough
    lux["a"][:4] += 200 * enough
    lux["b"] += 99 * daylight
    write_levels(tmp_path, chosen, light_of(chosen, [lux]), daylight)
    first, second = saved(tmp_path, "summary_grid")
    assert [first[f"Target Illuminance {x}"]["sDA"] for x in (300, 500, 750)] == [
        *(100, 50, 0)
    ]
    assert first["Minimum Illuminance 300"] == {"sDA": 100, "passes": True}
    assert not second["Minimum Illuminance 100"]["passes"]
    whole = saved(tmp_path, "summary")
    assert whole["Total Sensors"] == 12
    assert whole["Target Illuminance 300"] == {"sDA": 50, "passes": True}
    shares = whole["Target Illuminance Sensor Percentage"]
    assert list(shares.values()) == [0, 25, 25, 50]
    for kind, level in (("Target", 2), ("Minimum", 2)):
        place = tmp_path / "compliance_level" / f"{kind} Illuminance"
        assert set(np.loadtxt(place / "a.pf")) == {level}
        assert set(np.loadtxt(place / "b.pf")) == {0}


@pytest.mark.parametrize(("steps", "area"), [(2000, 100.0), (1999, 50.0)])
def test_credits_of_breeam_require_2000_hours_on_80_percent(
    chosen, tmp_path, steps, area
):
    """The mean is 300 lux, the darkest sensor 90 lux; "b" has the given hours."""
    lux = {}
    for name, count, hours in (("a", 8, 2000), ("b", 4, steps)):
        lux[name] = np.zeros((count, 8760))
        lux[name][:, :hours] = (300 * count - 90) / (count - 1) + 1e-6
        lux[name][:, hours] = 90
        lux[name][2, : hours + 1] = [90.0] * hours + [0.0]
    write_credits(tmp_path, chosen, light_of(chosen, [lux]))
    (total,) = saved(tmp_path, "summary")
    assert (total["comply"], total["credits"]) == ((True, 2) if area == 100 else (0, 0))
    assert total["total_area"] == pytest.approx(4)
    (program,) = saved(tmp_path, "program_summary")
    assert program["area_comply_%"] == pytest.approx(area)
    spaces = saved(tmp_path, "grid_summary")
    assert spaces["b"]["average-illuminance-hours"] == steps
    assert spaces["b"]["minimum-illuminance-hours"] == steps
    lowest = saved(tmp_path, "minimum_illuminance_sensors")
    assert lowest["a"]["pos"] == chosen.model.grids["a"].position[2].tolist()


def test_limits_of_breeam_follow_from_the_program_of_a_room(tmp_path):
    """Hospital rooms have two credits at 2,650 h, one at 2,000 h; a shop needs 200 lux.

    Of two rooms for patients of equal area, one has fewer hours; rooms without a
    program of BREEAM are offices.
    """
    programs = {
        "ward": "BREEAM::Healthcare_buildings::Patients_areas_and_consulting_rooms",
        "surgery": "BREEAM::Healthcare_buildings::Patients_areas_and_consulting_rooms",
        "shop": "BREEAM::Retail_buildings::Sales_areas",
        "hall": "2019::MediumOffice::ClosedOffice",
    }
    rooms = [office(name, x=10.0 * k) for k, name in enumerate(programs)]
    for room in rooms:
        energy = {"program_type": programs[room["identifier"]]}
        room.setdefault("properties", {})["energy"] = energy
    grids = [
        grid(name, 4, 0.5) | {"room_identifier": name}
        for name in (*programs, "nowhere")
    ]
    # Not beside results, where the postprocessing package looks for models
    path = tmp_path / "inputs" / "model.hbjson"
    path.parent.mkdir()
    path.write_text(json.dumps(honeybee_model(*rooms, sensor_grids=grids)))
    chosen = read_model(path)
    lux = {name: np.zeros((4, 8760)) for name in (*programs, "nowhere")}
    for name, level, hours in (
        *(("ward", 300, 2650), ("surgery", 300, 2100), ("shop", 200, 2650)),
        *(("hall", 300, 2000), ("nowhere", 300, 1999)),
    ):
        lux[name][:, :hours] = level
    write_credits(tmp_path, chosen, light_of(chosen, [lux]))
    kinds = saved(tmp_path, "grid_summary")
    assert kinds["hall"]["program-type"] == "BREEAM::Office_buildings::Occupied_spaces"
    assert {name: row["type"] for name, row in kinds.items()} == {
        "ward": "Healthcare buildings",
        "surgery": "Healthcare buildings",
        "shop": "Retail buildings",
        "hall": "Office buildings",
        "nowhere": "Office buildings",
    }
    found = {row["type"]: row["credits"] for row in saved(tmp_path, "summary")}
    assert found == {
        "Healthcare buildings": 1,
        "Retail buildings": 1,
        "Office buildings": 0,
    }
    health = saved(tmp_path, "program_summary")[0]
    assert health["area_comply_%"] == 100
    assert health["average-illuminance-hours"] == pytest.approx((2650 + 2100) / 2)
    grades = {
        name: set(np.loadtxt(tmp_path / "pass_fail" / f"{name}.pf")) for name in lux
    }
    assert grades == {name: {0 if name == "nowhere" else 3} for name in lux}


def sunny_office():
    """Sun of 2000 lux on a quarter of "a" in 300 occupied hours; 400 lux elsewhere.

    Closed blinds leave 100 lux. Grid "b" has 290 lux and no sun.
    """
    sunlit = np.zeros(8760, bool)
    sunlit[np.flatnonzero(OCCUPIED)[:300]] = True
    opened = {"a": np.full((8, 8760), 400.0), "b": np.full((4, 8760), 290.0)}
    closed = {"a": np.full((8, 8760), 100.0), "b": np.full((4, 8760), 90.0)}
    sun = {"a": np.zeros((8, 8760)), "b": np.zeros((4, 8760))}
    sun["a"][:2, sunlit] = 2000
    none = {name: np.zeros_like(lux) for name, lux in sun.items()}
    return [opened, closed], [sun, none], sunlit


def test_blinds_close_in_direct_sun_and_points_follow_from_sda_and_ase(
    chosen, tmp_path
):
    total, direct, sunlit = sunny_office()
    write_points(tmp_path, chosen, light_of(chosen, total, direct))
    rows, whole = saved(tmp_path, "summary_grid"), saved(tmp_path, "summary")
    assert (rows["a"]["sda"], rows["a"]["ase"]) == (100, 25)
    assert (rows["b"]["sda"], rows["b"]["ase"]) == (0, 0)
    assert rows["a"]["sda_blinds_down"] == 0
    assert (whole["sda"], whole["ase"], whole["credits"]) == (50, 12.5, 1)
    assert whole["total_floor_area"] == pytest.approx(4)
    states = np.array(saved(tmp_path, "states_schedule")["south"])
    assert np.array_equal(states > 0, sunlit)
    autonomy = np.loadtxt(tmp_path / "results" / "da" / "a.da")
    assert autonomy == pytest.approx(100 * (1 - 300 / 3650), abs=0.01)
    hours = np.loadtxt(tmp_path / "results" / "ase_hours_above" / "a.res")
    assert hours.tolist() == [300, 300, 0, 0, 0, 0, 0, 0]
    place = tmp_path / "datacollections" / "ase_percentage_above"
    shares = np.array(saved(place, "a")["values"])
    assert np.array_equal(shares, 25.0 * sunlit)


def test_sun_that_no_blind_stops_gives_no_points(chosen, tmp_path):
    total, (sun, _), sunlit = sunny_office()
    write_points(tmp_path, chosen, light_of(chosen, total, [sun, sun]))
    assert saved(tmp_path, "summary")["credits"] == 0
    failed = saved(tmp_path, "states_schedule_err")
    assert failed == {"a": np.flatnonzero(sunlit).tolist()}


def test_light_paths_of_a_grid_are_those_that_light_it(chosen, tmp_path):
    """The window "south" lights both grids, "north" only "b"; each has two states."""
    found = {}
    for path, (a, b) in {"south": (300.0, 30.0), "north": (0.0, 7.0)}.items():
        lux = {"a": np.full((8, 8760), a), "b": np.full((4, 8760), b)}
        half = {name: values / 2 for name, values in lux.items()}
        states = {
            f"{k}_state": {"total": each, "direct": each}
            for k, each in enumerate((lux, half))
        }
        found[path] = _lit(states) if found else states
    grids = tuple(_with_paths(record, found) for record in chosen.grids)
    assert [each.light_paths for each in grids] == [("south",), ("south", "north")]
    light = AnnualLight(grids, TIMES, 1, found, SUN_UP)
    write_illuminance(tmp_path, light)
    assert not list((tmp_path / "results" / "north").rglob("a.npy"))
    folder = read_honeybee(tmp_path / "results")
    assert folder.dynamic_paths("a") == ("south",)
    for name, first, second in (("a", 300, 150), ("b", 37, 33.5)):
        assert np.all(folder.illuminance(name) == first)
        assert np.all(folder.illuminance(name) == light.total(grids[name == "b"]))
        last = "north" if name == "b" else "south"
        assert np.all(folder.illuminance(name, states={last: 1}) == second)


@pytest.mark.slow
def test_the_postprocessing_package_finds_the_same_points(chosen, tmp_path):
    program = shutil.which("honeybee-radiance-postprocess")
    if program is None:
        pytest.skip("honeybee-radiance-postprocess is not installed")
    total, direct, _ = sunny_office()
    light = light_of(chosen, total, direct)
    write_illuminance(tmp_path, light)
    write_points(tmp_path / "ours", chosen, light)
    words = ["post-process", "leed", "daylight-option-one", "results", "--use-states"]
    folder = tmp_path / "theirs"
    subprocess.run(
        [program, *words, "-sf", str(folder)], cwd=tmp_path, check=True, timeout=300
    )
    ours, theirs = (saved(tmp_path / x, "summary_grid") for x in ("ours", "theirs"))
    for name, row in theirs.items():
        for key in ("sda", "ase", "sda_blinds_up", "total_sensor_count"):
            assert row[key] == pytest.approx(ours[name][key], abs=0.006)
