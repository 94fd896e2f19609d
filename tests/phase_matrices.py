"""Matrices of the phases whose product is known, under a uniform sky."""

import numpy as np
from scipy.sparse import csc_array

from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sensor_axis, sky_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import WindowMatrices, window_chain
from clerestory.sky.patch_radiance import SkyMatrix

KLEMS, SKY = klems("quarter"), reinhart(1)
SENSORS, STEPS = 70, 3
LUX = 179.0


def uniform_sky(radiance=(1.0, 2.0, 0.0)):
    """A white sky, uniform at each step; no ground light, no sun."""
    dome = np.ones((len(SKY), 1), np.float32)
    return SkyMatrix(
        partition=SKY,
        times=np.datetime64("2023-03-21T10:30") + np.arange(3) * np.timedelta64(1, "h"),
        diffuse=np.asarray(dome * radiance, dtype=np.float32),
        colour=np.ones((3, len(SKY))),
        sun=csc_array((len(SKY), STEPS), dtype=np.float32),
        sun_colour=np.ones(3),
        attributes={},
    )


def view(window, *, rng=None, count=0, share=1.0):
    """Sensors that see the whole hemisphere of the window: rows sum to π."""
    lam = share * KLEMS.projected_solid_angles()
    values = np.tile(lam, (3, SENSORS, 1))
    components = None
    if count:
        components = rng.normal(size=(count, *values.shape)) * 0.01
    rows, columns = sensor_axis(SENSORS), window_axis("interior", KLEMS, window)
    return TransferMatrix(values, rows, columns, components)


def transmission(tau):
    """A pane that lets the share tau pass, unscattered."""
    rows, columns = window_axis("interior", KLEMS), window_axis("exterior", KLEMS)
    return TransferMatrix(tau * np.eye(len(KLEMS))[None], rows, columns)


def daylight(window, *, rng=None, count=0):
    """Every patch sees all the sky alike: rows sum to one."""
    values = np.full((3, len(KLEMS), len(SKY)), 1 / len(SKY))
    components = None
    if count:
        components = rng.normal(size=(count, *values.shape)) * 0.001
    rows = window_axis("exterior", KLEMS, window)
    return TransferMatrix(values, rows, sky_axis(SKY), components)


def window_matrices(view, transmission, daylight):
    """V, T and D of a window, without direct correction."""
    return WindowMatrices(window_chain(view, transmission, daylight))
