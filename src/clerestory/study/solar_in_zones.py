"""Solar radiation in zones of a model: irradiance of the inside surfaces.

View matrices V of the zone, whose windows are black, give the irradiance of surfaces
and windows for the radiance of the windows' patches. Windows reflect diffusely:

    e = e₀ + G ρ e,   G = V 1/π

e₀ is the irradiance with black windows, ρ the diffuse back reflectance of the windows.
The radiation of each patch is absorbed in the zone: columns of V are scaled so that the
surfaces and windows absorb all of it, as view factors are.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.bands import GREY
from clerestory.brief_repr import brief
from clerestory.energyplus.building_model import ModelWindow
from clerestory.energyplus.zone_enclosure import InsideSurface
from clerestory.hemisphere.partition import RingPartition
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.traced_matrices import view_matrices
from clerestory.scene.model import Plastic, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.surface import Polygon, area_vector
from clerestory.scene.window import Window, window_of
from clerestory.scene.window_zones import spread_points
from clerestory.study.job import ZONES, Job

# Sensors of a surface or window, and paths of a sensor
_SENSORS, _PATHS = 256, 256

# Distances of windows and sensors from the walls [m]
_WINDOW, _SENSOR = 1e-3, 2e-3


@dataclass(frozen=True, eq=False)
class ZoneTransfer:
    """Transfer of solar radiation from the windows of a zone to its surfaces.

    Attributes
    ----------
    surfaces : inside surfaces
    areas : areas of the surfaces, without windows [m²]
    windows : windows of the zone
    to_surfaces, to_windows : mean irradiance of each surface and window, per radiance
        of the patches of each window [sr]
    closure : absorbed radiation per radiation of each window before the scaling, for
        patches of equal radiance
    """

    surfaces: Sequence[InsideSurface]
    areas: Float[np.ndarray, " surface"]
    windows: Sequence[ModelWindow]
    to_surfaces: Sequence[Float[np.ndarray, "surface _"]]
    to_windows: Sequence[Float[np.ndarray, "window _"]]
    closure: Float[np.ndarray, " window"]

    __repr__ = brief

    def irradiance(
        self,
        radiance: Sequence[Float[np.ndarray, "_ time"]],
        reflectance: Float[np.ndarray, "window time"],
    ) -> tuple[Float[np.ndarray, "surface time"], Float[np.ndarray, "window time"]]:
        """Return the irradiance of surfaces and of the windows' indoor sides [W/m²].

        Parameters
        ----------
        radiance : radiance of the patches of each window, over (patch, time)
            [W/(m²·sr)]
        reflectance : diffuse back reflectance of each window
        """
        walls = sum(V @ L for V, L in zip(self.to_surfaces, radiance, strict=True))
        panes = sum(V @ L for V, L in zip(self.to_windows, radiance, strict=True))
        # Interreflection between windows and room
        on_walls, on_panes = (
            np.stack([V.sum(axis=1) / np.pi for V in part], axis=1)
            for part in (self.to_surfaces, self.to_windows)
        )
        system = np.eye(len(self.windows)) - on_panes * reflectance.T[:, None, :]
        known = np.asarray(panes).T[:, :, None]
        received = np.linalg.solve(system, known)[:, :, 0].T
        return np.asarray(walls + on_walls @ (reflectance * received)), received


def zone_transfer(
    job: Job,
    surfaces: Sequence[InsideSurface],
    windows: Sequence[tuple[ModelWindow, RingPartition]],
    *,
    zone: str,
) -> ZoneTransfer:
    """Trace the transfer of a zone, or read it from the store of the study.

    Parameters
    ----------
    windows : windows of the zone, each with the patches of its BSDFs
    zone : name of the zone, for the names of stored matrices
    """
    scene, openings = _room(surfaces, windows)
    sensors, counts, areas = _sensors(surfaces, openings)
    effort = replace(job.pixel_effort(_PATHS, ZONES), bounces=None)
    trace = partial(view_matrices, scene, openings, sensors=sensors)
    found = job.matrices(
        f"solar-{zone}", openings, trace, effort, shown=f"solar matrices of {zone}"
    )
    absorptance = np.array([surface.absorptance for surface in surfaces])
    means = [_means(found[window.name], counts) for window in openings]
    weight = np.concatenate(
        [areas[: len(surfaces)] * absorptance, areas[len(surfaces) :]]
    )
    scaled, closure = [], []
    for each, window, area in zip(means, openings, areas[len(surfaces) :], strict=True):
        sent = area * window.partition.projected_solid_angles()
        absorbed = weight @ each
        closure.append(absorbed.sum() / sent.sum())
        factor = np.divide(sent, absorbed, out=np.zeros_like(sent), where=absorbed > 0)
        scaled.append(each * factor)
    return ZoneTransfer(
        surfaces,
        areas[: len(surfaces)],
        [window for window, _ in windows],
        [each[: len(surfaces)] for each in scaled],
        [each[len(surfaces) :] for each in scaled],
        np.array(closure),
    )


def _room(
    surfaces: Sequence[InsideSurface],
    windows: Sequence[tuple[ModelWindow, RingPartition]],
) -> tuple[Scene, list[Window]]:
    # The zone with grey surfaces, and its windows slightly inside their walls
    materials = {
        surface.name: Plastic(surface.name, np.array([1 - surface.absorptance]))
        for surface in surfaces
    }
    polygons = tuple(Polygon(s.vertices, s.name, s.name) for s in surfaces)
    openings = []
    for window, partition in windows:
        inward = _inward(window)
        corners = window.corners + _WINDOW * inward
        front = corners if area_vector(corners) @ inward > 0 else corners[::-1]
        polygon = Polygon(front, window.name, window.name)
        openings.append(window_of((polygon,), name=window.name, partition=partition))
    return Scene(materials, polygons, bands=GREY), openings


def _inward(window: ModelWindow) -> Float[np.ndarray, "3"]:
    return -window.outward


def _sensors(
    surfaces: Sequence[InsideSurface], openings: Sequence[Window]
) -> tuple[Sensors, list[int], Values]:
    # Sensors on the surfaces, but not behind windows, and on the windows; their
    # numbers, and the areas of surfaces and windows
    places, directions, counts, areas = [], [], [], []
    for surface in surfaces:
        polygon = Polygon(surface.vertices, surface.name)
        points = spread_points([polygon], _SENSORS)
        holes = [w for w in openings if _lies_in(w, surface)]
        hidden = np.zeros(len(points), dtype=bool)
        for window in holes:
            hidden |= _within(window, points)
        points = points[~hidden]
        whole = float(np.linalg.norm(area_vector(surface.vertices)))
        areas.append(whole - sum(window.area for window in holes))
        places.append(points + _SENSOR * surface.normal)
        directions.append(np.broadcast_to(surface.normal, points.shape))
        counts.append(len(points))
    for window in openings:
        points = spread_points(window.polygons, _SENSORS)
        places.append(points + _SENSOR * window.frame.normal)
        directions.append(np.broadcast_to(window.frame.normal, points.shape))
        counts.append(len(points))
        areas.append(window.area)
    sensors = Sensors(np.concatenate(places), np.concatenate(directions))
    return sensors, counts, np.array(areas)


def _lies_in(window: Window, surface: InsideSurface) -> bool:
    # Whether a window lies in the plane of a surface
    apart = (window.polygons[0].vertices - surface.vertices[0]) @ surface.normal
    facing = window.frame.normal @ surface.normal
    return bool(facing > 0.99 and np.abs(apart).max() < 10 * _WINDOW)


def _within(window: Window, points: Float[np.ndarray, "point 3"]) -> np.ndarray:
    # Whether points are within the triangles of a window, seen along its normal
    frame, found = window.frame, np.zeros(len(points), dtype=bool)
    axes = np.array([frame.right, frame.up])
    for triangles in window.triangles():
        corners = triangles.vertices[triangles.faces] @ axes.T
        for a, b, c in corners:
            edges = ((a, b), (b, c), (c, a))
            signs = [_side(points @ axes.T - p, q - p) for p, q in edges]
            found |= np.all([s >= 0 for s in signs], axis=0)
            found |= np.all([s <= 0 for s in signs], axis=0)
    return found


def _side(point: np.ndarray, edge: np.ndarray) -> np.ndarray:
    return np.asarray(edge[0] * point[:, 1] - edge[1] * point[:, 0])


def _means(
    matrix: TransferMatrix, counts: Sequence[int]
) -> Float[np.ndarray, "surface patch"]:
    # Mean over the sensors of each surface or window
    parts = np.split(matrix.values.mean(axis=0), np.cumsum(counts)[:-1])
    return np.stack([part.mean(axis=0) for part in parts])
