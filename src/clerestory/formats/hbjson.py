"""Reader of honeybee models (HBJSON).

If an exterior aperture has a BSDF or dynamic states, exterior glazing becomes window
groups. Other surfaces become the scene; interior faces, given twice, are read once.

Reference: ladybug-tools, honeybee-schema, the JSON schema of honeybee models.
"""

import warnings
from collections import Counter
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.documents import read_json
from clerestory.errors import ClerestoryWarning, located
from clerestory.formats.building_model import (
    ApertureGroup,
    BuildingModel,
    seamed,
    unique_name,
)
from clerestory.formats.hbjson_checks import check_model
from clerestory.formats.hbjson_geometry import (
    plane_of,
    read_grids,
    read_views,
    room_floor,
)
from clerestory.formats.hbjson_modifiers import BsdfModifier, Modifier, read_modifiers
from clerestory.formats.hbjson_schema import (
    Model,
    Part,
    Room,
    ShadeMesh,
    ignored_members,
)
from clerestory.scene.materials.mixture import Void
from clerestory.scene.model import Material, Polygon, Scene, Surface, insert_material
from clerestory.scene.scaling import METRES

_METRES = {
    "Meters": METRES["metres"],
    "Millimeters": METRES["millimetres"],
    "Centimeters": METRES["centimetres"],
    "Feet": METRES["feet"],
    "Inches": METRES["inches"],
}
_HORIZONTAL = ("RoofCeiling", "Floor")
_SETS = {"Wall": "wall_set", "Floor": "floor_set", "RoofCeiling": "roof_ceiling_set"}


def read_hbjson(path: str | Path, *, window_groups: bool = False) -> BuildingModel:
    """Read a honeybee model from an HBJSON file.

    With `window_groups`, all exterior glazing becomes window groups, one for each room,
    plane and modifier. By default it does so if an aperture has a BSDF or states, and
    rooms may share groups. Warns if the largest dimension of the model is less than 1 m
    or more than 10 km.

    Raises
    ------
    InputError : the file is not JSON or not a honeybee model, or the model cannot be
        simulated, such as with an open room
    """
    root = read_json(path, Model)
    with located(file=path):
        scale = _METRES[root.units]
        check_model(root, metres=scale)
        reading = _Reading(root, path, all_windows=window_groups, by_room=window_groups)
        if reading.groups and not window_groups:
            reading = _Reading(root, path, all_windows=True)
        scene = Scene(reading.materials, tuple(reading.surfaces))
        _warn_of_size(scene, root.units, path)
        grids, labels = read_grids(root.radiance, scale)
        ignored = (*reading.modifiers.unsupported, *ignored_members(root))
        return BuildingModel(
            name=root.display_name or root.identifier,
            scene=scene,
            windows=tuple(_windows(list(reading.groups.values()))),
            grids=grids,
            labels=labels,
            rooms=tuple(room_floor(room, scale) for room in root.rooms),
            views=read_views(root.radiance, scale),
            unsupported=tuple(dict.fromkeys(ignored)),
        )


def _warn_of_size(scene: Scene, units: str, path: str | Path) -> None:
    size = float(np.ptp(scene.bounds(), axis=0).max()) if scene.surfaces else 1.0
    if not 1 <= size <= 10_000:
        message = f"{path}: the model is {size:.3g} m wide in its units, {units}"
        warnings.warn(f"{message}; 1 m to 10 km expected", ClerestoryWarning, 3)


@dataclass
class _Group:
    # Coplanar apertures of one dynamic group, or with the same modifier
    name: str
    states: list[Modifier]
    polygons: list[np.ndarray] = field(default_factory=list)


class _Reading:
    # Surfaces and window groups of a model. With `all_windows`, all exterior glazing
    # becomes window groups, with `by_room` of apertures of one room.
    def __init__(
        self,
        root: Model,
        path: str | Path,
        *,
        all_windows: bool,
        by_room: bool = False,
    ) -> None:
        self.room = ""
        self.modifiers = read_modifiers(root.radiance, path)
        self.scale, self.all_windows = _METRES[root.units], all_windows
        self.materials: dict[str, Material] = {}
        self.surfaces: list[Surface] = []
        self.groups: dict[tuple[object, ...], _Group] = {}
        self.seen: set[str] = set()
        for room in root.rooms:
            own = room.modifier_set or ""
            self.room = room.identifier if by_room else ""
            for face in room.faces:
                self.face(face, own)
            self.shades(room, own)
        self.room = ""
        for face in root.orphaned_faces:
            self.face(face, "")
        for aperture in root.orphaned_apertures:
            self.aperture(aperture, "", outdoors=True)
        for door in root.orphaned_doors:
            self.door(door, "")
        for shade in root.orphaned_shades:
            self.shade(shade, "", _shade_place(shade))
        for mesh in root.shade_meshes:
            self.shade_mesh(mesh)

    def face(self, face: Part, room_set: str) -> None:
        """Add a face with its openings and shades."""
        if self.is_twin(face):
            return
        for aperture in face.apertures:
            roof, outdoors = face.face_type in _HORIZONTAL, face.exposure == "Outdoors"
            self.aperture(aperture, room_set, outdoors=outdoors, roof=roof)
        for door in face.doors:
            self.door(door, room_set, overhead=face.face_type in _HORIZONTAL)
        self.shades(face, room_set)
        if face.face_type == "AirBoundary":
            return
        side = "exterior" if face.exposure == "Outdoors" else "interior"
        place = f"{_SETS[face.face_type]}.{side}_modifier"
        modifier = self.of(face, place, room_set)
        openings = (*face.apertures, *face.doors)
        holes = [opening.loops()[0] for opening in openings]
        outline = seamed([*face.loops(), *holes]) * self.scale
        self.put(outline, modifier, face.identifier)

    def aperture(
        self, aperture: Part, room_set: str, *, outdoors: bool, roof: bool = False
    ) -> None:
        """Add an aperture to the scene or to a window group."""
        if self.is_twin(aperture):
            return
        self.shades(aperture, room_set)
        key = ("skylight" if roof else "window") if outdoors else "interior"
        key = "operable" if outdoors and aperture.is_operable else key
        modifier = self.of(aperture, f"aperture_set.{key}_modifier", room_set)
        states = self.states(aperture)
        plain = not (states or self.all_windows or isinstance(modifier, BsdfModifier))
        if outdoors and not plain:
            self.window(aperture, states or [modifier])
            return
        name = aperture.identifier
        if states:
            self.modifiers.unsupported.append(f'the states of inner aperture "{name}"')
        self.put(self.outline(aperture), states[0] if states else modifier, name)

    def window(self, opening: Part, states: list[Modifier]) -> None:
        """Add an opening to a window group."""
        outline = self.outline(opening)[::-1]
        name = opening.group or " ".join(filter(None, (self.room, states[0].name)))
        group = self.groups.setdefault((name, *plane_of(outline)), _Group(name, states))
        group.polygons.append(outline)

    def states(self, part: Part) -> list[Modifier]:
        """Return one modifier per dynamic state of an aperture or a shade."""
        states = part.states or ()
        if any(state.shades for state in states):
            text = f'the shades of states of "{part.identifier}"'
            self.modifiers.unsupported.append(text)
        if any(state.vmtx_geometry or state.dmtx_geometry for state in states):
            text = f'the matrix geometry of states of "{part.identifier}"'
            self.modifiers.unsupported.append(text)
        owner, named = part.identifier, [s.modifier for s in states if s.modifier]
        return [self.modifiers.of(name, "", owner=owner) for name in named]

    def door(self, door: Part, room_set: str, *, overhead: bool = False) -> None:
        """Add a door to the scene or to a window group."""
        if self.is_twin(door):
            return
        self.shades(door, room_set)
        side = "exterior" if door.exposure == "Outdoors" else "interior"
        key = f"{side}_glass" if door.is_glass else side
        key = "overhead" if overhead and key == "exterior" else key
        modifier = self.of(door, f"door_set.{key}_modifier", room_set)
        if door.exposure == "Outdoors" and door.is_glass and self.all_windows:
            self.window(door, [modifier])
        else:
            self.put(self.outline(door), modifier, door.identifier)

    def shades(self, owner: Part | Room, room_set: str) -> None:
        """Add the shades of a room, face or opening."""
        for shade in owner.outdoor_shades:
            self.shade(shade, room_set, "shade_set.exterior_modifier")
        for shade in owner.indoor_shades:
            self.shade(shade, room_set, "shade_set.interior_modifier")

    def shade(self, shade: Part, room_set: str, place: str) -> None:
        """Add a shade, in the first of its dynamic states."""
        modifier = self.of(shade, place, room_set)
        states, name = self.states(shade), shade.identifier
        if states:
            text = f'the states of shade "{name}": the first is used'
            self.modifiers.unsupported.append(text)
        self.put(self.outline(shade), states[0] if states else modifier, name)

    def shade_mesh(self, mesh: ShadeMesh) -> None:
        """Add the faces of a mesh."""
        vertices, count = np.array(mesh.vertices) * self.scale, len(mesh.vertices)
        modifier = self.of(mesh, _shade_place(mesh))
        for face in mesh.faces:
            message = f'a face of mesh "{mesh.identifier}" refers to vertex {max(face)}'
            require(max(face) < count, f"{message}; an index below {count} expected")
            self.put(vertices[list(face)], modifier, mesh.identifier)

    def of(self, part: Part | ShadeMesh, place: str, room_set: str = "") -> Modifier:
        """Return the modifier of an object; see `Modifiers.of`."""
        return self.modifiers.of(part.modifier, place, room_set, owner=part.identifier)

    def outline(self, part: Part) -> np.ndarray:
        """Return the outline of a face, opening or shade, joined with its holes [m]."""
        return seamed(part.loops()) * self.scale

    def put(self, vertices: np.ndarray, modifier: Modifier, name: str) -> None:
        """Add a surface, or list it as unsupported if its modifier is a BSDF."""
        if isinstance(modifier, BsdfModifier):
            self.modifiers.unsupported.append(
                f'BSDF "{modifier.name}" of "{name}": only exterior windows can have a'
                " BSDF; the surface is omitted"
            )
            return
        if isinstance(modifier, Void):
            text = f'surface "{name}": its modifier "{modifier.name}" is void'
            self.modifiers.unsupported.append(text)
            return
        key = insert_material(self.materials, modifier)
        self.surfaces.append(Polygon(vertices, key, name))

    def is_twin(self, part: Part) -> bool:
        """Whether the same face or opening was already read from the adjacent room."""
        if part.exposure != "Surface":
            return False
        self.seen.add(part.identifier)
        return bool(part.twins and part.twins[0] in self.seen)


def _shade_place(shade: Part | ShadeMesh) -> str:
    # Default modifier of shades without a parent: context, if they are detached
    return "context_modifier" if shade.is_detached else "shade_set.exterior_modifier"


def _windows(groups: Sequence[_Group]) -> Iterator[ApertureGroup]:
    # Number the groups that have equal names but lie in different planes
    total = Counter(group.name for group in groups)
    number: Counter[str] = Counter()
    names: set[str] = set()
    for group in groups:
        number[group.name] += 1
        suffix = f".{number[group.name]}" if total[group.name] > 1 else ""
        bsdfs = (m.up for m in group.states if isinstance(m, BsdfModifier))
        name = unique_name(group.name + suffix, names)
        names.add(name)
        yield ApertureGroup(
            name,
            tuple(group.polygons),
            next(bsdfs, None),
            tuple((modifier.name, modifier) for modifier in group.states),
        )
