"""Checks of honeybee models: identifiers, closed rooms, orientation of faces, extent.

A room is closed if the moments of its surface are those of a volume V. By the
divergence theorem, the area vectors a of the faces and the moments of their centroids c
satisfy Σ a = 0 and Σ cᵢ aⱼ = V δᵢⱼ, whatever the division of the surface into faces.
"""

from collections.abc import Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.checks import distinct, require
from clerestory.formats.hbjson_schema import Model, Part, Room
from clerestory.scene.surface import area_vector

# Largest distance from the origin [m]: 32-bit coordinates are then exact to 1 mm
_FARTHEST = 10_000.0

# Smallest tolerance of positions [m], and tolerance relative to the area of a room
_TOLERANCE, _SHARE = 0.01, 1e-3


def check_model(root: Model, *, metres: float) -> None:
    """Require that a model can be simulated.

    `metres` is the length of the unit of the model.

    Raises
    ------
    InputError : identifiers are not unique, a corner is far from the origin, a room is
        open or a face or opening has the wrong orientation; the message names it
    """
    _check_extent(root, metres)
    _check_identifiers(root)
    tolerance = max(root.tolerance * metres, _TOLERANCE)
    for room in root.rooms:
        _check_room(room, metres, tolerance)
    for face in _faces(root):
        for kind, opening in _openings(face):
            _check_opening(kind, opening, face, metres, tolerance)


def _check_extent(root: Model, metres: float) -> None:
    parts = [*_parts(root)]
    loops = [*(p.boundary for p in parts), *(m.vertices for m in root.shade_meshes)]
    farthest = max((float(np.abs(loop).max()) for loop in loops), default=0.0) * metres
    require(
        farthest <= _FARTHEST,
        f"a corner is {farthest / 1000:.6g} km from the origin; at most"
        f" {_FARTHEST / 1000:g} km expected: move the model to the origin",
    )


def _check_identifiers(root: Model) -> None:
    # Adjacency refers to identifiers in rooms; those of objects without room may repeat
    faces = [face for room in root.rooms for face in room.faces]
    openings = [pair for face in faces for pair in _openings(face)]
    distinct((room.identifier for room in root.rooms), "rooms")
    distinct((face.identifier for face in faces), "faces")
    for kind in ("aperture", "door"):
        distinct((o.identifier for k, o in openings if k == kind), f"{kind}s")


def _faces(root: Model) -> list[Part]:
    return [*(f for room in root.rooms for f in room.faces), *root.orphaned_faces]


def _openings(face: Part) -> Iterator[tuple[str, Part]]:
    yield from (("aperture", each) for each in face.apertures)
    yield from (("door", each) for each in face.doors)


def _parts(root: Model) -> Iterator[Part]:
    # All faces, openings and shades of a model
    owners: list[Room | Part] = [*root.rooms, *_faces(root)]
    for owner in owners:
        yield from (*owner.outdoor_shades, *owner.indoor_shades)
    for face in _faces(root):
        yield face
        for _, opening in _openings(face):
            yield from (opening, *opening.outdoor_shades, *opening.indoor_shades)
    yield from (*root.orphaned_apertures, *root.orphaned_doors, *root.orphaned_shades)


def _check_room(room: Room, metres: float, tolerance: float) -> None:
    if not room.faces:
        return
    surface = _Surface([[loop * metres for loop in f.loops()] for f in room.faces])
    named, allowed = f'room "{room.identifier}"', surface.allowed(tolerance)
    signs = np.ones(len(room.faces))
    missing = surface.unbalanced(signs)
    if missing > allowed:
        # If the room is closed after one face is flipped, only that face is wrong
        for number, face in enumerate(room.faces):
            flipped = np.where(np.arange(len(signs)) == number, -1.0, 1.0)
            require(
                surface.unbalanced(flipped) > allowed,
                f'face "{face.identifier}" of {named} faces inwards; vertices'
                " counter-clockwise as seen from outside the room expected",
            )
    require(
        missing <= allowed,
        f"{named} is open or has overlapping faces: {missing:.3g} m² of its surface are"
        " not balanced; a closed room expected",
    )
    require(
        surface.volume(signs) > 0,
        f"{named} is inside out; vertices of its faces counter-clockwise as seen from"
        " outside expected",
    )


class _Surface:
    # Area vector [m²] and moments [m³] of each face of a room, and its size [m]
    def __init__(self, faces: Sequence[Sequence[Float[np.ndarray, "_ 3"]]]) -> None:
        corners = np.concatenate([loops[0] for loops in faces])
        middle = corners.mean(axis=0)
        parts = [_face_moments(loops, middle) for loops in faces]
        self.area = np.array([area for area, _ in parts])
        self.moment = np.array([moment for _, moment in parts])
        self.size = max(float(np.ptp(corners, axis=0).max()), _TOLERANCE)
        self.edges = sum(_perimeter(loops[0]) for loops in faces) / 2

    def allowed(self, tolerance: float) -> float:
        """Return the area that a tolerance of positions leaves unbalanced [m²]."""
        total = float(np.linalg.norm(self.area, axis=1).sum())
        return max(tolerance * self.edges, _SHARE * total)

    def volume(self, signs: Float[np.ndarray, " face"]) -> float:
        """Return the enclosed volume, with some faces flipped [m³]."""
        return float(np.trace(np.tensordot(signs, self.moment, axes=1))) / 3

    def unbalanced(self, signs: Float[np.ndarray, " face"]) -> float:
        """Return the area by which the surface is not closed [m²]."""
        moment = np.tensordot(signs, self.moment, axes=1)
        rest = moment - np.trace(moment) / 3 * np.eye(3)
        area = float(np.linalg.norm(signs @ self.area))
        return max(area, float(np.abs(rest).max()) / self.size)


def _face_moments(
    loops: Sequence[Float[np.ndarray, "_ 3"]], middle: Vector
) -> tuple[Vector, Float[np.ndarray, "3 3"]]:
    # Area vector, and ∫ x dA relative to the middle of the room, from fans of triangles
    area, moment = np.zeros(3), np.zeros((3, 3))
    for number, loop in enumerate(loops):
        along = number > 0 and area_vector(loop) @ area > 0
        points = (loop[::-1] if along else loop) - middle
        for a, b in pairwise(points[1:]):
            part = np.cross(a - points[0], b - points[0]) / 2
            area += part
            moment += np.outer((points[0] + a + b) / 3, part)
    return area, moment


def _perimeter(loop: Float[np.ndarray, "point 3"]) -> float:
    return float(np.linalg.norm(np.roll(loop, -1, axis=0) - loop, axis=1).sum())


def _check_opening(
    kind: str, opening: Part, face: Part, metres: float, tolerance: float
) -> None:
    outline, host = opening.loops()[0] * metres, face.loops()[0] * metres
    normal = area_vector(host)
    length = float(np.linalg.norm(normal))
    if length < tolerance**2:
        return
    named = f'{kind} "{opening.identifier}"'
    require(
        area_vector(outline) @ normal >= 0,
        f'{named} faces opposite to face "{face.identifier}"; vertices in the same'
        " order expected",
    )
    away = float(np.abs((outline - host[0]) @ normal).max()) / length
    require(
        away <= 2 * tolerance,
        f'{named} is {away:.3g} m from the plane of face "{face.identifier}"; at most'
        f" {2 * tolerance:g} m expected",
    )


def check_modifiers(items: Iterable[tuple[str, object]]) -> None:
    """Require that modifiers of one identifier are equal."""
    known: dict[str, object] = {}
    repeated = [name for name, value in items if known.setdefault(name, value) != value]
    distinct([*repeated, *repeated], "modifiers")
