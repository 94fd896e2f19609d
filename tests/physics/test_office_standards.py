"""An office of three spaces, two orientations and four tilts in one study.

sDA and ASE of every space equal those of honeybee-radiance-postprocess for the hourly
illuminance of the run, in a folder that this package writes.
"""

import json
import os
import subprocess

import pytest

from clerestory.metrics.en17037 import daylight_provision
from clerestory.metrics.honeybee_writer import write_honeybee
from clerestory.metrics.replicates import errors_of
from clerestory.metrics.space import spaces_of
from clerestory.study.compliance_table import assessments_of
from clerestory.study.config import read_study
from clerestory.study.study_run import run_study
from office_study import write_office

SCRIPT = """
import json, sys
from honeybee_radiance_postprocess.annual import occupancy_schedule_8_to_6
from honeybee_radiance_postprocess.results.annual_daylight import AnnualDaylight
hours = occupancy_schedule_8_to_6(as_list=True)
results = AnnualDaylight(sys.argv[1], schedule=hours)
daylit, info = results.spatial_daylight_autonomy()
sunlit = results.annual_sunlight_exposure()[0]
names = [grid["name"] for grid in info]
pairs = zip(map(float, daylit), map(float, sunlit))
print(json.dumps(dict(zip(names, pairs))))
"""


@pytest.fixture(scope="module")
def office(shared_data, tmp_path_factory):
    """Results of the study."""
    weather = shared_data / "weather" / "Oslo.epw"
    if not weather.is_file():
        pytest.skip("no weather file Oslo.epw in the shared data")
    folder = tmp_path_factory.mktemp("office")
    file = write_office(folder, weather, samples=64, views=False)
    return run_study(read_study(file), out=folder / "out").data


@pytest.mark.slow
def test_every_space_has_a_verdict_and_en17037_is_that_of_its_functions(office):
    found = {(a.standard, a.space): a for a in assessments_of(office)}
    names = ["room a", "room b", "room c", "all spaces"]
    assert [space for name, space in found if name == "LM-83-12"] == names
    for space in spaces_of(office):
        own = daylight_provision(
            space.data["illuminance"],
            space.data["daylight_hours"].values.astype(bool),
            area=space.area,
            **errors_of(space.data),
        )
        verdict = found["EN 17037", space.name].verdicts[0]
        assert verdict.level == own.level
        assert verdict.quantities[0].value == pytest.approx(100 * own.target[0].value)
        assert found["LM-83-12", space.name].area == pytest.approx(20.0, rel=1e-3)


@pytest.mark.slow
def test_sda_and_ase_of_the_run_equal_those_of_the_program(office, tmp_path):
    python = os.environ.get("CLERESTORY_HONEYBEE")
    if not python:
        pytest.skip("CLERESTORY_HONEYBEE names no Python with honeybee's postprocess")
    total, direct = (
        {
            space.name: space.data[name].values.astype(float)
            for space in spaces_of(office)
        }
        for name in ("illuminance", "direct_open")
    )
    write_honeybee(tmp_path / "hb", total, office["time"].values, direct=direct)
    done = subprocess.run(
        [python, "-c", SCRIPT, str(tmp_path / "hb")],
        capture_output=True,
        text=True,
        check=True,
    )
    expected = json.loads(done.stdout.splitlines()[-1])
    for one in assessments_of(office):
        if one.standard == "LM-83-12" and one.space in expected:
            shares = [verdict.quantities[0].value for verdict in one.verdicts]
            # The program gives sDA as a fraction and ASE in %
            daylit, sunlit = expected[one.space]
            assert shares == pytest.approx([100 * daylit, sunlit], abs=1e-9)
