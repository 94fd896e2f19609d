"""The studies that come with the repository can be read, with all their files."""

import warnings
from pathlib import Path

import pytest

from clerestory.scene.sensors import read_sensors
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs

STUDIES = Path(__file__).parents[3] / "studies"
# The measured classroom needs its measurement, which is not here
OURS = sorted(
    file
    for file in STUDIES.glob("*/study.toml")
    if file.parent.name != "measured_classroom"
)


def test_there_are_six_studies_and_the_example_of_one_day():
    assert len(OURS) >= 7


@pytest.mark.parametrize("file", OURS, ids=lambda file: file.parent.name)
def test_a_study_reads_with_all_its_files(file):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        study = read_study(file)
        inputs = read_inputs(study)
    assert inputs.scene.surfaces
    assert len(inputs.groups) == len(study.window)
    low, high = inputs.scene.bounds()
    for table in study.sensors:
        places = read_sensors(table.file).position
        assert ((places >= low) & (places <= high)).all()
