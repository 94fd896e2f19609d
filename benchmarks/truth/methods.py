"""Three and five phases of the room, for sensors and for the eyes' pictures."""

from functools import cache

import numpy as np

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.image.camera import Camera
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import FIVE_PHASE, THREE_PHASE, five_phase
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.picture_series import pictures_over_time
from clerestory.phases.sun_coefficients import (
    picture_sun_coefficients,
    sun_coefficients,
)
from clerestory.sky.sun_matrix import sun_matrix
from truth.setting import Kind, cameras, demo, pictured, weather


@cache
def bsdfs(kind: Kind) -> tuple[Bsdf, Bsdf]:
    """Return the system's BSDF in Klems patches, and its tensor tree.

    Prisms scatter the sun into narrow beams, for which a tree's cells are made small.
    """
    halvings, samples = (7, 512) if kind.clear else (6, 2000)
    return cl.generate_bsdf(kind.cell, samples=20000, geometry=False), cl.generate_bsdf(
        kind.cell, basis="tree4", halvings=halvings, samples=samples, sides="front",
        geometry=False,
    )  # fmt: skip


def illuminances(
    kind: Kind, coarse: Bsdf, fine: Bsdf, *, samples: int
) -> tuple[np.ndarray, np.ndarray]:
    """Illuminance by three and by five phases (sensor, step) [lux]."""
    scene, window, sensors, _ = demo()
    T = coarse.transmission_matrix(window=window.name)
    effort = {"samples": samples}
    D, D_d = _daylight(samples)
    V = cl.view_matrix(scene, window, sensors=sensors, seed=1, **effort)
    V_d = cl.view_matrix(
        blackened(scene), window, sensors=sensors, seed=3, bounces=1, **effort
    )
    suns = sun_matrix(weather(), sun_formula="radiance")
    C_ds = sun_coefficients(
        scene, [window], window.name, fine, sensors=sensors,
        suns=suns.directions, peak=kind.peak, samples=1024, seed=5,
    )  # fmt: skip
    parts = WindowMatrices(
        window_chain(V, T, D), window_chain(V_d, T, D_d), MatrixChain((C_ds,))
    )
    result = five_phase([parts], *_skies(weather()), suns)
    return result["three_phase"].values, result["illuminance"].values


def pictures(
    kind: Kind,
    coarse: Bsdf,
    fine: Bsdf,
    *,
    rows: int,
    samples: int,
    hours: cl.Weather | None = None,
) -> tuple[np.ndarray, np.ndarray]:
    """Pictures by three and by five phases (eye, step, pixel, channel)."""
    shown = hours or pictured()
    scene, window, _, _ = demo()
    T = coarse.transmission_matrix(window=window.name)
    D, D_d = _daylight(rows)
    suns = sun_matrix(shown, sun_formula="radiance")
    S, S_ds = _skies(shown)
    three, five = [], []
    for number, camera in enumerate(cameras()):
        V, V_d = (
            picture_view_matrices(
                scene, [window], camera, direct=direct, samples=samples, seed=number
            )[window.name]
            for direct in (False, True)
        )
        C_ds = picture_sun_coefficients(
            scene, [window], window.name, fine, camera,
            suns=suns.directions, peak=kind.peak, samples=32, seed=10 + number,
        )  # fmt: skip
        matrices = WindowMatrices(
            window_chain(V, T, D), window_chain(V_d, T, D_d), MatrixChain((C_ds,))
        )
        for terms, found in ((THREE_PHASE, three), (FIVE_PHASE, five)):
            made = pictures_over_time([matrices], terms, camera, Skies(S, S_ds, suns))
            found.append(_shown(camera, made))
    return np.array(three), np.array(five)


def _shown(camera: Camera, made) -> list[np.ndarray]:
    return [picture.radiance.reshape(len(camera), 3) for picture in made]


def _daylight(samples: int) -> tuple[TransferMatrix, TransferMatrix]:
    scene, window, _, _ = demo()
    return (
        cl.daylight_matrix(scene, window, samples=samples, seed=2),
        cl.daylight_matrix(
            blackened(scene), window, samples=samples, seed=4, bounces=0
        ),
    )


def _skies(hours: cl.Weather):
    return tuple(
        cl.sky_matrix(hours, include=part, sun_formula="radiance")
        for part in ("all", "sun")
    )
