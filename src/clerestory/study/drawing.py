"""Scene geometry and BSDFs that are stored in the results for drawings."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.hemisphere.klems import klems
from clerestory.scene.model import Scene, display_colour
from clerestory.scene.tessellate import meshes
from clerestory.scene.triangulate import triangulate
from clerestory.scene.window import Window
from clerestory.study.window_groups import WindowGroup


def room_drawing(scene: Scene) -> xr.Dataset:
    """Return the surfaces of a scene as triangles [m], with material colours 0…1.

    The dataset is empty for a scene without surfaces.
    """
    if not scene.surfaces:
        return xr.Dataset()
    corners, colours, names = [], [], []
    for mesh in meshes(scene):
        shown = np.clip(display_colour(mesh.material), 0, 1)
        corners.append(mesh.vertices[mesh.faces])
        colours.append(np.tile(shown, (len(mesh.faces), 1)))
        names += [mesh.material.name] * len(mesh.faces)
    return xr.Dataset(
        {
            "triangle": (("triangle", "corner", "xyz"), _single(corners)),
            "triangle_colour": (("triangle", "channel"), _single(colours)),
            "triangle_material": ("triangle", np.array(names, dtype=str)),
        }
    )


def window_drawing(windows: Sequence[Window]) -> xr.Dataset:
    """Return the windows as triangles [m], with centre, normal and up vector.

    The dataset is empty without windows.
    """
    if not windows:
        return xr.Dataset()
    parts = [_window_corners(window) for window in windows]
    index = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    frames = [window.frame for window in windows]
    corner_axes = ("window_triangle", "corner", "xyz")
    return xr.Dataset(
        {
            "window_triangle": (corner_axes, _single(parts)),
            "window_index": ("window_triangle", index.astype(np.int32)),
            "window_centre": (("window", "xyz"), [_centroid(part) for part in parts]),
            "window_normal": (("window", "xyz"), [frame.normal for frame in frames]),
            "window_up": (("window", "xyz"), [frame.up for frame in frames]),
        },
        coords={"window": np.array([window.name for window in windows], dtype=str)},
    )


def layer_drawing(groups: Sequence[WindowGroup]) -> xr.Dataset:
    """Return the BTDF of each shade state [1/sr] for light from outside (Klems full).

    The BTDF is stored once for shade states with the same BSDF file and name.
    """
    shown: dict[tuple[str, str], list[str]] = {}
    values = []
    patches = klems("full")
    for group in groups:
        for state in group.states:
            key = (str(state.fine.source), state.name)
            if key not in shown:
                part = state.fine.scattering("transmission_front")
                values.append(part.average(patches, patches))
            shown.setdefault(key, []).append(group.name)
    if not values:
        return xr.Dataset()
    names = [
        f"{', '.join(windows)}: {state}" if state else ", ".join(windows)
        for (_, state), windows in shown.items()
    ]
    layers, axes = np.stack(values).astype(np.float32), ("layer", "exit", "incident")
    return xr.Dataset(
        {"layer_transmission": (axes, layers, {"units": "1/sr"})},
        coords={"layer": np.array(names, dtype=str)},
    )


def _single(parts: list[np.ndarray]) -> np.ndarray:
    return np.concatenate(parts).astype(np.float32)


def _window_corners(window: Window) -> Float[np.ndarray, "triangle 3 3"]:
    filled = [triangulate(polygon.vertices) for polygon in window.polygons]
    return np.concatenate([part.vertices[part.faces] for part in filled])


def _centroid(corners: Float[np.ndarray, "triangle 3 3"]) -> Float[np.ndarray, "3"]:
    sides = corners[:, 1:] - corners[:, :1]
    area = np.linalg.norm(np.cross(sides[:, 0], sides[:, 1]), axis=1)
    return np.asarray(np.average(corners.mean(axis=1), axis=0, weights=area))
