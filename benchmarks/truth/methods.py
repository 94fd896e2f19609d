"""Three and five phases of the room, for sensors and for the eyes' pictures.

V and D belong to the room and to the parts of its window. They are traced once for all
systems that fill the same parts, as are the paths from pixels to the windows.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.bsdf.bsdf import Bsdf
from clerestory.hemisphere.klems import klems
from clerestory.image.camera import Camera
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import FIVE_PHASE, THREE_PHASE, five_phase, three_phase
from clerestory.phases.picture_matrices import reflected_view_matrices
from clerestory.phases.picture_series import pictures_over_time
from clerestory.phases.shaded_windows import (
    ShadedWindow,
    ShadeState,
    receiving_matrices,
)
from clerestory.phases.sun_coefficients import sun_coefficients
from clerestory.phases.traced_matrices import daylight_matrices, view_matrices
from clerestory.phases.window_paths import WindowPaths, picture_window_paths
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window
from clerestory.sky.sky_matrix import Include
from clerestory.sky.sun_matrix import sun_matrix
from truth.facades import Kind, Part
from truth.jackknife import indices
from truth.kept import Arrays
from truth.setting import demo, pane

Matrices = dict[str, TransferMatrix]


@dataclass(frozen=True)
class MethodPaths:
    """Paths of the methods, and subdivision MF of the sky's patches.

    `row` is for a row of V, D and C_ds, `pixel` for a pixel of V - V_d, `direct` for
    one of V_d and C_ds.
    """

    row: int
    pixel: int
    direct: int
    subdivision: int = 4


@dataclass(frozen=True)
class TreeEffort:
    """Resolution of the trees, 2^halvings, and paths of their smallest cells."""

    halvings: int
    samples: int


def tree_effort(part: Part) -> TreeEffort:
    """Return the effort of a tree: films scatter the sun into narrow beams."""
    return TreeEffort(7, 256) if part.clear else TreeEffort(6, 1000)


def sun_flux(
    kind: Kind, hours: cl.Weather, paths: MethodPaths, folder: Path | None
) -> np.ndarray:
    """Flux of the sun through the first part, spread over patches (step) [W/m²]."""
    windows = _windows(kind)
    _, D_d = _daylight(windows, paths)
    name = _panes(windows)[0].name
    T = bsdfs(kind.parts[0], folder)[0].transmission_matrix(window=name)
    spread = (T @ D_d[name]).values[0] @ _skies(hours, paths)[1].values[0]
    return klems("full").projected_solid_angles() @ spread


@cache
def bsdfs(part: Part, folder: Path | None) -> tuple[Bsdf, Bsdf]:
    """Return the BSDF of a system in Klems patches, and its tensor tree.

    They are kept in the folder, for other façades with the same part.
    """
    made = []
    for basis, make in (
        ("klems", partial(klems_bsdf, part)),
        ("tree", partial(tree_bsdf, part, tree_effort(part))),
    ):
        file = folder / f"{part.name}-{basis}.xml" if folder else None
        if file and file.exists():
            made.append(cl.read_bsdf(file))
            continue
        made.append(make())
        if file:
            cl.write_bsdf(file, made[-1], digits=6)
    return made[0], made[1]


def klems_bsdf(part: Part, *, samples: int = 20000, seed: int = 0) -> Bsdf:
    """Return the BSDF in Klems patches."""
    return cl.generate_bsdf(part.cell, samples=samples, geometry=False, seed=seed)


def tree_bsdf(part: Part, effort: TreeEffort, *, seed: int = 0) -> Bsdf:
    """Return the tensor tree of the transmission of outdoor light."""
    return cl.generate_bsdf(
        part.cell, basis="tree4", halvings=effort.halvings, samples=effort.samples,
        sides="front", geometry=False, seed=seed,
    )  # fmt: skip


def illuminances(
    kind: Kind,
    hours: cl.Weather,
    sensors: Sensors,
    *,
    paths: MethodPaths,
    folder: Path | None = None,
) -> Arrays:
    """Return illuminance (sensor, step) by `three` and `five` phases [lux].

    Parts of five phases are the light of the sky, sun that arrives straight from the
    window, and sun that the room has reflected.
    """
    windows, room = _windows(kind), demo()[0]
    D, D_d = _daylight(windows, paths)
    V, V_d = (
        view_matrices(scene, _panes(windows), sensors=sensors, seed=seed, **effort)
        for scene, seed, effort in (
            (room, 1, {"samples": paths.row}),
            (blackened(room), 3, {"samples": paths.row, "bounces": 1}),
        )
    )
    suns = sun_matrix(hours, sun_formula="radiance")
    matrices = []
    for part, window in zip(kind.parts, _panes(windows), strict=True):
        coarse, fine = bsdfs(part, folder)
        name = window.name
        T = coarse.transmission_matrix(window=name)
        C_ds = sun_coefficients(
            room, _panes(windows), name, fine, sensors=sensors,
            suns=suns.directions, peak=part.peak, samples=4096, seed=5,
        )  # fmt: skip
        whole = window_chain(V[name], T, D[name])
        direct = window_chain(V_d[name], T, D_d[name])
        matrices.append(WindowMatrices(whole, direct, MatrixChain((C_ds,))))
    S, S_ds = _skies(hours, paths)
    result = five_phase(matrices, S, S_ds, suns)
    sun, sky = (
        three_phase(matrices, part)["illuminance"].values
        for part in (S_ds, sky_of(hours, paths, "sky"))
    )
    return {
        "lux_three": result["three_phase"].values,
        "lux_five": result["illuminance"].values,
        "lux_sky": sky,
        "lux_direct_sun": result["direct_sun"].values,
        "lux_reflected_sun": sun - result["direct_in_patches"].values,
    }


def glares(
    kind: Kind,
    hours: cl.Weather,
    cameras: Sequence[Camera],
    *,
    paths: MethodPaths,
    folder: Path | None = None,
) -> Arrays:
    """Return glare indices (index, eye, step) by `three` and `five` phases."""
    found = {"three": [], "five": []}
    pairs = [bsdfs(part, folder) for part in kind.parts]
    for camera in cameras:
        made = pictures(kind, hours, camera, pairs, paths)
        for method, values in found.items():
            values.append([indices(camera, each) for each in made[method]])
    return {
        f"glare_{method}": np.moveaxis(np.array(values), -1, 0)
        for method, values in found.items()
    }


def pictures(
    kind: Kind,
    hours: cl.Weather,
    camera: Camera,
    bsdfs: Sequence[tuple[Bsdf, Bsdf]],
    paths: MethodPaths,
    *,
    seed: int = 0,
) -> dict[str, np.ndarray]:
    """Return pictures (step, pixel, channel) by `three` and `five` phases.

    `sky` is the part of both that is not due to the sun. `bsdfs` are those of each
    part, in Klems patches and as a tree.
    """
    windows = _windows(kind)
    D, D_d = _daylight(windows, paths, seed)
    V, beams = _views(windows, _key(camera), paths, seed)
    shaded = []
    parts = zip(kind.parts, _panes(windows), bsdfs, strict=True)
    for part, window, (coarse, fine) in parts:
        name = window.name
        T = coarse.transmission_matrix(window=name)
        state = ShadeState(
            whole=(T, D[name]), direct=(T, D_d[name]), bsdf=fine, peak=part.peak
        )
        shaded.append(ShadedWindow(window, (state,)))
    suns = sun_matrix(hours, sun_formula="radiance")
    matrices = receiving_matrices(shaded, V, beams, suns.directions)
    S, S_ds = _skies(hours, paths)
    only = Skies(sky_of(hours, paths, "sky"))
    both = Skies(S, S_ds, suns)
    made = {}
    for method, terms, skies in (
        ("three", THREE_PHASE, both),
        ("five", FIVE_PHASE, both),
        ("sky", THREE_PHASE, only),
    ):
        series = pictures_over_time(matrices, terms, camera, skies)
        made[method] = np.array([each.radiance.reshape(-1, 3) for each in series])
    return made


_Edges = tuple[tuple[float, float], ...]


def _windows(kind: Kind) -> _Edges:
    # Heights of the parts, for which matrices are traced once
    return tuple((part.low, part.high) for part in kind.parts)


def _panes(edges: _Edges) -> list[Window]:
    return [pane(f"from {low:.2f} m", low, high) for low, high in edges]


_CAMERAS: dict[bytes, Camera] = {}


def _key(camera: Camera) -> bytes:
    key = np.concatenate([camera.view.position, camera.view.direction]).tobytes()
    _CAMERAS[key] = camera
    return key


@cache
def _views(
    edges: _Edges, key: bytes, paths: MethodPaths, seed: int
) -> tuple[Matrices, WindowPaths]:
    camera, room, panes = _CAMERAS[key], demo()[0], _panes(edges)
    return (
        reflected_view_matrices(
            room, panes, camera, samples=paths.pixel, seed=seed + 21
        ),
        picture_window_paths(room, panes, camera, samples=paths.direct, seed=seed + 22),
    )


@cache
def _daylight(
    edges: _Edges, paths: MethodPaths, seed: int = 0
) -> tuple[Matrices, Matrices]:
    room, panes = demo()[0], _panes(edges)
    effort = {"samples": paths.row, "subdivision": paths.subdivision}
    return (
        daylight_matrices(room, panes, seed=seed + 2, **effort),
        daylight_matrices(blackened(room), panes, seed=seed + 4, bounces=0, **effort),
    )


def _skies(hours: cl.Weather, paths: MethodPaths) -> tuple[cl.SkyMatrix, ...]:
    return tuple(sky_of(hours, paths, part) for part in ("all", "sun"))


def sky_of(hours: cl.Weather, paths: MethodPaths, part: Include) -> cl.SkyMatrix:
    """Return S, or its part that is due to the sun or the sky."""
    return cl.sky_matrix(
        hours, include=part, sun_formula="radiance", subdivision=paths.subdivision
    )
