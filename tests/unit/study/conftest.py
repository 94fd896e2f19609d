"""The study of the ten-polygon room, and tracing replaced by known matrices."""

import shutil
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sensor_axis, sky_axis, sun_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.study import study_coefficients, study_tracing

ROOM = Path(__file__).parents[2] / "cli" / "room"
TRANSMITTANCE = 0.5


@pytest.fixture
def study_file(tmp_path):
    """A copy of the study that a test may spoil."""
    folder = tmp_path / "study"
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "diffuser.xml", lambertian(TRANSMITTANCE, klems("quarter")))
    return folder / "study.toml"


class FakeEngine:
    """Sensors that see nothing but the window, a window that sees nothing but sky.

    The irradiance under a sky of radiance one is then π times the transmittance.
    """

    def __init__(self):
        self.calls = []

    def view_matrices(self, _scene, windows, *, sensors, effort, progress):
        self.calls.append("view")
        progress(1.0, "done")
        count = len(sensors)
        traced = {}
        for window in windows:
            lam = window.partition.projected_solid_angles() / len(windows)
            values = np.tile(lam, (3, count, 1))
            noise = np.random.default_rng(effort.seed).normal(size=(2, *values.shape))
            columns = window_axis("interior", window.partition, window.name)
            traced[window.name] = TransferMatrix(
                values, sensor_axis(count), columns, 0.01 * noise
            )
        return traced

    def daylight_matrix(self, _scene, window, *, subdivision, progress, **_effort):
        self.calls.append("daylight")
        progress(1.0, "done")
        sky = reinhart(subdivision)
        values = np.full((3, len(window.partition), len(sky)), 0.0)
        weight = sky.solid_angles()[1:] / (2 * np.pi)
        values[:, :, 1:] = weight
        rows = window_axis("exterior", window.partition, window.name)
        return TransferMatrix(values, rows, sky_axis(sky))

    def daylight_coefficients(
        self, _scene, *, sensors, subdivision, progress, **_effort
    ):
        self.calls.append("coefficients")
        progress(1.0, "done")
        sky = reinhart(subdivision)
        values = np.zeros((3, len(sensors), len(sky)))
        values[:, :, 1:] = sky.dome.projected_solid_angles()
        return TransferMatrix(values, sensor_axis(len(sensors)), sky_axis(sky))

    def separate_coefficients(
        self, _scene, *, sensors, subdivision, windows, progress, **_effort
    ):
        found = self.daylight_coefficients(
            _scene, sensors=sensors, subdivision=subdivision, progress=progress
        )
        return found, found

    def unscattered_sun(self, _scene, *, sensors, suns, **_effort):
        self.calls.append("sun")
        values = np.tile(np.maximum(suns[:, 2], 0), (1, len(sensors), 1))
        rows = sensor_axis(len(sensors))
        return TransferMatrix(values, rows, sun_axis(len(suns)))


@pytest.fixture
def engine(monkeypatch):
    fake = FakeEngine()
    for module, name in (
        (study_tracing, "view_matrices"),
        (study_tracing, "daylight_matrix"),
        (study_coefficients, "daylight_coefficients"),
        (study_coefficients, "separate_coefficients"),
        (study_coefficients, "unscattered_sun"),
    ):
        monkeypatch.setattr(module, name, getattr(fake, name))
    return fake
