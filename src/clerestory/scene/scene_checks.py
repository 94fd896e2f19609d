"""Plausibility checks of the geometry of scenes, windows and sensors.

Results are warnings, since unusual positions of sensors may be intended. The most
frequent error is a window whose front faces outdoors.
"""

import warnings
from collections.abc import Iterator, Mapping, Sequence

import numpy as np
from jaxtyping import Bool, Float

from clerestory.array_types import RayVectors, Vector
from clerestory.directions import Frame
from clerestory.errors import ClerestoryWarning
from clerestory.scene.coplanar import check_coplanar
from clerestory.scene.desk_views import is_blocked
from clerestory.scene.model import Scene
from clerestory.scene.proximity import Triangulation, distances, first_hits
from clerestory.scene.sensors import Sensors
from clerestory.scene.tessellate import meshes
from clerestory.scene.view import View
from clerestory.scene.window import Window

# Distance below which a surface and a sensor or window touch [m]
_TOUCH = 1e-3

# A sensor is enclosed if half of its rays hit a surface within this distance [m]
_SHUT_IN = 0.25

# Minimum and maximum plausible dimensions of scenes [m]
_SMALLEST, _LARGEST = 0.1, 2000.0

# Maximum number of sensors times triangles; if it is larger, only every n-th sensor is
# checked for surrounding surfaces
_EFFORT = 300_000_000

_RAYS = 64
_DOWN = np.array([[0.0, 0.0, -1.0]])
_UP_AND_DOWN = np.array([[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]])

# Heights of rooms without a warning [m], and number of points where they are measured
_LOWEST, _HIGHEST, _PROBES = 0.5, 40.0, 20

_CONVERSION = "the key `units` of [scene], or `!xform -s FACTOR`, converts"


def warn_of_scene(
    scene: Scene, windows: Sequence[Window] = (), sensors: Sensors | None = None
) -> None:
    """Warn of implausible geometry; see `check_scene`."""
    for finding in check_scene(scene, windows, sensors):
        warnings.warn(finding, ClerestoryWarning, stacklevel=2)


def check_scene(
    scene: Scene,
    windows: Sequence[Window] = (),
    sensors: Sensors | None = None,
    views: Mapping[str, View] | None = None,
) -> tuple[str, ...]:
    """Return warnings about implausible geometry, one line for each problem.

    Warnings are given for sensors that are outside the scene, on a surface, enclosed by
    surfaces, without a surface below, in the plane of a window, or duplicate; for
    windows that have the sensors behind them, are outside the scene, or are covered by
    a surface; for overlapping coplanar surfaces; for views, by name, into a partition
    or a wall; and for scenes of implausible size. `scene` does not contain the windows.
    In large scenes a subset of the sensors is checked for surrounding surfaces; the
    warnings give the number of sensors checked.

    >>> check_scene(Scene())
    ('the scene has no surfaces',)
    """
    if not scene.surfaces:
        return ("the scene has no surfaces",)
    parts = meshes(scene)
    if not parts:
        return ("the surfaces of the scene have no area",)
    corner = np.concatenate([m.vertices[m.faces] for m in parts])
    triangles = Triangulation(corner, np.concatenate([m.surface for m in parts]))
    box = scene.bounds()
    findings = [*_size(box), *check_coplanar(scene, triangles)]
    for window in windows:
        findings += _window(window, scene, box, triangles, sensors)
    opaque = np.array([scene.materials[s.material].opaque for s in scene.surfaces])
    solid = triangles.of(opaque)
    if sensors is not None and len(sensors):
        findings += _height(sensors.position, triangles)
        findings += _sensors(sensors, box, windows)
        findings += _surroundings(sensors, box, solid)
    findings += _blocked(views or {}, solid)
    return tuple(findings)


def _blocked(views: Mapping[str, View], solid: Triangulation) -> Iterator[str]:
    # Plans and sections, which have no viewpoint, are not checked
    for name, view in views.items():
        if view.kind != "parallel" and is_blocked(solid, view):
            yield f'view "{name}" faces a partition or a wall less than 1 m away'


def _size(box: Float[np.ndarray, "2 3"]) -> Iterator[str]:
    size = float(np.ptp(box, axis=0).max())
    if size > _LARGEST or size < _SMALLEST:
        yield (f"the scene is {size:.3g} m across; is it in metres? {_CONVERSION}")


def _height(points: RayVectors, triangles: Triangulation) -> Iterator[str]:
    # Median distance from floor to ceiling at some of the points
    heights = []
    for point in points[:: 1 + len(points) // _PROBES]:
        corner = triangles.along_vertical(point).corner
        heights.append(first_hits(point, _UP_AND_DOWN, corner).sum())
    height = float(np.median(heights))
    if np.isfinite(height) and not _LOWEST <= height <= _HIGHEST:
        yield f"the room is {height:.3g} m high; is it in metres? {_CONVERSION}"


def _window(
    window: Window,
    scene: Scene,
    box: Float[np.ndarray, "2 3"],
    triangles: Triangulation,
    sensors: Sensors | None,
) -> Iterator[str]:
    label = f'window "{window.name}"'

    # Sensors must be in the room, on the front side of the window; in buildings, most
    # sensors are in other rooms, but not the nearest
    if sensors is not None and len(sensors):
        heights = _heights(window, sensors)
        middle = np.concatenate([p.vertices for p in window.polygons]).mean(axis=0)
        away = np.linalg.norm(sensors.position - middle, axis=1)
        behind = int((heights < -_TOUCH).sum())
        if behind > len(sensors) / 2 and heights[away.argmin()] < -_TOUCH:
            yield (
                f"{label} has {behind} of {len(sensors)} sensors behind it; its front"
                " should face the room: reverse its vertices, or read it by"
                " `!xform -I`"
            )

    corner = np.concatenate([p.vertices for p in window.polygons])
    outside = float(np.max([box[0] - corner, corner - box[1]]))
    if outside > 0.01:
        yield f"{label} extends {outside:.3g} m beyond the surfaces of the scene"

    # Surfaces in the plane of the window cover it
    covers = set()
    for part in window.triangles():
        for middle in part.vertices[part.faces].mean(axis=1):
            near = triangles.near(middle, _TOUCH)
            touching = distances(middle, near.corner) < _TOUCH
            covers |= set(near.surface[touching].tolist())
    names = [scene.surfaces[i].name for i in sorted(covers)]
    if names:
        more = f" and {len(names) - 1} more" if len(names) > 1 else ""
        yield (
            f'{label} is covered by the surface "{names[0]}"{more}; a window replaces'
            " its glazing, which should not be in the scene"
        )


def _heights(window: Window, sensors: Sensors) -> Float[np.ndarray, " sensors"]:
    # Distance of each sensor from the window's plane, positive in front
    return np.asarray(
        (sensors.position - window.polygons[0].vertices[0]) @ window.frame.normal
    )


def _outside(
    sensors: Sensors, box: Float[np.ndarray, "2 3"]
) -> Bool[np.ndarray, " sensors"]:
    low, high = sensors.position < box[0] - _TOUCH, sensors.position > box[1] + _TOUCH
    return np.asarray(np.any(low | high, axis=1))


def _sensors(
    sensors: Sensors, box: Float[np.ndarray, "2 3"], windows: Sequence[Window]
) -> Iterator[str]:
    out = _outside(sensors, box)
    yield from _finding(sensors, out, "outside the bounding box of all surfaces")

    table = np.concatenate([sensors.position, sensors.direction], axis=1).round(6)
    _, first = np.unique(table, axis=0, return_index=True)
    twice = np.ones(len(sensors), dtype=bool)
    twice[first] = False
    yield from _finding(sensors, twice, "given twice")

    for window in windows:
        on_plane = np.abs(_heights(window, sensors)) < _TOUCH
        where = f'in the plane of window "{window.name}" and receive no light from it'
        yield from _finding(sensors, on_plane, where)


def _surroundings(
    sensors: Sensors, box: Float[np.ndarray, "2 3"], solid: Triangulation
) -> Iterator[str]:
    out = _outside(sensors, box)
    touching, shut_in, floating = (np.zeros(len(sensors), dtype=bool) for _ in range(3))
    most = max(1, _EFFORT // max(1, len(solid.corner)))
    looked = range(0, len(sensors), -(-len(sensors) // most))
    for i in looked:
        point, direction = sensors.position[i], sensors.direction[i]
        near = solid.near(point, _SHUT_IN)
        touching[i] = distances(point, near.corner).min(initial=np.inf) < _TOUCH
        sees = first_hits(point, _hemisphere(direction), near.corner)
        shut_in[i] = not touching[i] and np.median(sees) < _SHUT_IN
        down = first_hits(point, _DOWN, solid.beneath(point).corner)
        floating[i] = not (touching[i] or out[i]) and np.isinf(down[0])
    for which, where in (
        (touching, f"nearer than {_TOUCH * 1e3:.0f} mm to a surface"),
        (
            shut_in,
            f"enclosed, with half of the view nearer than {_SHUT_IN} m: in a wall,"
            " below the floor or inside furniture?",
        ),
        (floating, "without a surface below: below the floor or outdoors?"),
    ):
        yield from _finding(sensors, which, where, looked=len(looked))


def _hemisphere(direction: Vector) -> RayVectors:
    # Uniform directions over the hemisphere around a sensor's direction, on a spiral
    frame = Frame.from_normal_up(direction, np.eye(3)[np.argmin(np.abs(direction))])
    cosine = (np.arange(_RAYS) + 0.5) / _RAYS
    angle = np.arange(_RAYS) * np.pi * (3 - np.sqrt(5))
    sine = np.sqrt(1 - cosine**2)
    local = np.stack([sine * np.cos(angle), sine * np.sin(angle), cosine], axis=1)
    return np.asarray(local @ np.stack([frame.right, frame.up, frame.normal]))


def _finding(
    sensors: Sensors,
    which: Bool[np.ndarray, " sensors"],
    where: str,
    *,
    looked: int | None = None,
) -> Iterator[str]:
    # One line for all sensors with the same problem, naming the first five sensors
    found = np.flatnonzero(which).tolist()
    if not found:
        return
    known = sensors.names or range(1, len(sensors) + 1)
    shown = ", ".join(str(known[i]) for i in found[:5])
    shown += ", …" if len(found) > 5 else ""
    checked_all = looked in (None, len(sensors))
    note = "" if checked_all else f", {looked} of which were checked,"
    if len(found) == 1:
        yield f"sensor {shown} of {len(sensors)}{note} is {where}"
    else:
        yield f"{len(found)} ({shown}) of {len(sensors)} sensors{note} are {where}"
