"""Windows as secondary light sources, as by Radiance mkillum.

The radiance of a window towards the room under one sky is traced for each direction and
zone of the window, and stored as an illum. Renderings then sample the illum as a light
source, while camera rays see the window itself.
"""

from dataclasses import replace
from typing import Unpack

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB
from clerestory.checks import one_of, require, within
from clerestory.directions import Frame, unit
from clerestory.engine.effort import EffortKeywords, effort_of
from clerestory.engine.radiance_jobs import (
    PICTURE_BATCHES,
    EmitterPatches,
    ExitingRadianceJob,
    estimate_radiance,
)
from clerestory.engine.unsampled_light import warn_of_unsampled_light
from clerestory.engine.work_units import Goal
from clerestory.errors import InputError
from clerestory.phases.traced_matrices import warn_if_short
from clerestory.radiance.illum_table import LeavingLight, light_pattern
from clerestory.scene.model import Illum, Material, Polygon, Scene
from clerestory.scene.surface import is_parallelogram
from clerestory.scene.triangulate import triangulate

# Default, if neither samples nor relative_error is given
_DEFAULT = Goal(samples=None, relative_error=0.03)


def precompute_illums(
    room: Scene,
    panes: Scene,
    *,
    zone: float = np.inf,
    rings: int = 18,
    **keywords: Unpack[EffortKeywords],
) -> Scene:
    """Return windows as illums that emit their transmitted and reflected radiance.

    Render them in place of the windows: `room + illums`. Direct sunlight through clear
    panes is not included; rendering samples the sun through the window, as Radiance
    does. The illums are valid for this sky, room and window alone.

    Parameters
    ----------
    room : the scene without the windows, with its sky and sun
    panes : polygons of the windows, whose front faces the room
    zone : maximum edge length of pane zones [m]; only parallelogram panes are divided
    rings : number of polar angle intervals; there are twice as many azimuth intervals
    samples : number of paths per direction and zone
    relative_error : instead of samples: target RMS of the standard errors over all
        directions, relative to the mean radiance; 0.03 if neither is given
    bounces : maximum number of diffuse reflections of light before it enters the window
    seed : random seed ≥ 0; same seed and device, bitwise identical results
    device : "auto" selects a GPU if one is available
    executor : executor of the tracing jobs, such as a `Cluster`; default: local
    progress : callback with the completed fraction (0…1) and a status text

    Raises
    ------
    InputError : a pane that is not a polygon, no panes, or a number out of range
    DeviceError : no usable compute device
    """
    effort = effort_of(precompute_illums, keywords, default=_DEFAULT)
    require(zone > 0, f"edge length of zones is {zone:g} m; a positive length expected")
    within(rings, "number of rings", least=2, most=90)
    pieces = [piece for pane in panes.surfaces for piece in _zones(pane, zone)]
    require(pieces, "no panes given; at least one polygon expected")
    patches = _patches(pieces)
    whole = room + panes
    one_of(whole.bands, "bands of the scene", choices=(RGB,))
    warn_of_unsampled_light(whole)
    job = ExitingRadianceJob(
        scene=whole,
        patches=patches,
        rings=rings,
        sectors=2 * rings,
        **effort.job_options(PICTURE_BATCHES),
    )
    lit = estimate_radiance(job, effort)
    warn_if_short(lit, "light of the windows", effort)
    radiance = lit.value.reshape(len(pieces), rings, 2 * rings, 3)
    materials: dict[str, Material] = {}
    surfaces = []
    for number, piece in enumerate(pieces):
        seen = panes.materials[piece.material]
        key = f"{piece.material}_illum{number}"
        light = LeavingLight(patches.frame[number], radiance[number])
        pattern = light_pattern(light)
        materials[key] = Illum(key, np.ones(3), seen, None, pattern)
        surfaces.append(replace(piece, material=key))
    return Scene(materials, tuple(surfaces))


def _zones(pane: object, zone: float) -> list[Polygon]:
    if not isinstance(pane, Polygon):
        name = getattr(pane, "name", "")
        raise InputError(f'pane "{name}" is not a polygon; flat panes expected')
    corner = pane.vertices
    if len(corner) != 4 or not is_parallelogram(corner):
        return [pane]
    u, v = corner[1] - corner[0], corner[3] - corner[0]
    across, along = (max(1, int(np.ceil(np.linalg.norm(e) / zone))) for e in (u, v))
    found = []
    for i in range(across):
        for j in range(along):
            low = corner[0] + u * i / across + v * j / along
            right, up = u / across, v / along
            around = np.array([low, low + right, low + right + up, low + up])
            found.append(replace(pane, vertices=around))
    return found


def _patches(pieces: list[Polygon]) -> EmitterPatches:
    frames, corners, cumulative = [], [], []
    for piece in pieces:
        triangles = triangulate(piece.vertices)
        corner = triangles.vertices[triangles.faces]
        doubled = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        area = np.linalg.norm(doubled, axis=1)
        require(area.sum() > 0, f'pane "{piece.name}" has area 0; above 0 expected')
        share = np.cumsum(area) / area.sum()
        share[-1] = 1.0
        frames.append(_frame(doubled.sum(axis=0)))
        corners.append(corner)
        cumulative.append(share)
    return EmitterPatches(
        np.array(frames),
        np.concatenate(corners),
        np.cumsum([0, *map(len, corners)]),
        np.concatenate(cumulative),
    )


def _frame(normal: Float[np.ndarray, "3"]) -> Float[np.ndarray, "3 3"]:
    # Two axes in the plane, the second as close to vertical as possible, and the normal
    up = np.eye(3)[1 if abs(unit(normal)[2]) > 0.999 else 2]
    frame = Frame.from_normal_up(normal, up)
    return np.array([frame.right, frame.up, frame.normal])
