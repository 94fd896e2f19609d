"""Reader of honeybee models (HBJSON).

Exterior apertures with a BSDF or with states become window groups; all other surfaces
become the scene. Interior faces, which a model contains twice, are read once.

Reference: ladybug-tools, honeybee-schema, the JSON schema of honeybee models.
"""

import warnings
from dataclasses import dataclass, field
from pathlib import Path
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.errors import ClerestoryWarning
from clerestory.formats.hbjson_geometry import plane_of, read_grids, read_views, seamed
from clerestory.formats.hbjson_modifiers import (
    BsdfModifier,
    Modifier,
    Modifiers,
    read_modifiers,
)
from clerestory.formats.json_item import Item, read_json
from clerestory.scene.model import (
    Material,
    Polygon,
    Scene,
    Surface,
    insert_material,
)
from clerestory.scene.sensors import Sensors
from clerestory.scene.view import View

_METRES = {
    "Meters": 1.0,
    "Millimeters": 1e-3,
    "Centimeters": 1e-2,
    "Feet": 0.3048,
    "Inches": 0.0254,
}
_SETS = {"Wall": "wall_set", "Floor": "floor_set", "RoofCeiling": "roof_ceiling_set"}


@final
@dataclass(frozen=True, eq=False)
class ApertureGroup:
    """Apertures that form one window group.

    Attributes
    ----------
    name : name of the window group
    polygons : outlines, counter-clockwise as seen from the room [m]
    up : up vector of the BSDF; None: default up vector
    states : name and modifier of each state; one entry for a window without states
    """

    name: str
    polygons: tuple[Float[np.ndarray, "point 3"], ...]
    up: Float[np.ndarray, "3"] | None
    states: tuple[tuple[str, Modifier], ...]


@final
@dataclass(frozen=True, eq=False)
class HoneybeeModel:
    """A honeybee model.

    Attributes
    ----------
    name : name of the model
    scene : all surfaces except the window groups
    windows : window groups
    grids, views : sensor grids and views by name
    unsupported : descriptions of omitted items
    """

    name: str
    scene: Scene
    windows: tuple[ApertureGroup, ...]
    grids: dict[str, Sensors]
    views: dict[str, View]
    unsupported: tuple[str, ...]


@dataclass
class _Model:
    # Part of the model that has been read so far
    modifiers: Modifiers
    scale: float
    # Whether all exterior glazing becomes window groups; true if any aperture does
    all_windows: bool = False
    materials: dict[str, Material] = field(default_factory=dict)
    surfaces: list[Surface] = field(default_factory=list)
    groups: dict[tuple[object, ...], list[np.ndarray]] = field(default_factory=dict)
    states: dict[tuple[object, ...], tuple[tuple[str, Modifier], ...]] = field(
        default_factory=dict
    )
    seen: set[str] = field(default_factory=set)

    def outline(self, geometry: Item) -> np.ndarray:
        """Return the boundary of a Face3D with its holes [m]."""
        loops = [geometry.points("boundary", 3), *geometry.loops("holes")]
        return seamed([loop * self.scale for loop in loops])

    def put(self, vertices: np.ndarray, modifier: Modifier, name: str) -> None:
        """Add a surface; if its modifier is a BSDF, omit and report it."""
        if isinstance(modifier, BsdfModifier):
            self.modifiers.unsupported.append(
                f'the BSDF "{modifier.name}" of "{name}", which is no window to the'
                " outdoors: left open"
            )
            return
        key = insert_material(self.materials, modifier)
        self.surfaces.append(Polygon(vertices, key, name))


def read_hbjson(path: str | Path) -> HoneybeeModel:
    """Read a honeybee model from an HBJSON file.

    Warns if the largest dimension of the model is less than 1 m or more than 10 km.

    Raises
    ------
    InputError : the file is not JSON, or not a honeybee model
    """
    root = read_json(path)
    if root.text("type", "Model") != "Model":
        raise root.wrong("type", '"Model"')
    units = root.text("units", "Meters")
    if units not in _METRES:
        raise root.wrong("units", f"one of {', '.join(_METRES)}")
    model = _collect(root, _METRES[units], all_windows=False)
    if model.groups:
        model = _collect(root, _METRES[units], all_windows=True)
    radiance = root.item("properties").item("radiance")
    scene = Scene(model.materials, tuple(model.surfaces))
    _warn_of_size(scene, units, path)
    return HoneybeeModel(
        root.text("display_name", "") or root.text("identifier", "model"),
        scene,
        _windows(model),
        dict(read_grids(radiance, model.scale)),
        dict(read_views(radiance, model.scale)),
        tuple(dict.fromkeys(model.modifiers.unsupported)),
    )


def _collect(root: Item, scale: float, *, all_windows: bool) -> _Model:
    radiance = root.item("properties").item("radiance")
    model = _Model(read_modifiers(radiance), scale, all_windows)
    for room in root.items("rooms"):
        _room(room, model)
    for face in root.items("orphaned_faces"):
        _face(face, model, "")
    for aperture in root.items("orphaned_apertures"):
        _aperture(aperture, model, "", outdoors=True)
    for door in root.items("orphaned_doors"):
        _door(door, model, "")
    for shade in root.items("orphaned_shades"):
        _shade(shade, model, "", "context")
    for mesh in root.items("shade_meshes"):
        _shade_mesh(mesh, model)
    return model


def _warn_of_size(scene: Scene, units: str, path: str | Path) -> None:
    if not scene.surfaces:
        return
    low, high = scene.bounds()
    size = float(np.max(high - low))
    if not 1 <= size <= 10_000:
        warnings.warn(
            f"{path}: the model is {size:.3g} m wide in its units, {units}: are they"
            " right?",
            ClerestoryWarning,
            stacklevel=3,
        )


def _room(room: Item, model: _Model) -> None:
    own = room.item("properties").item("radiance").text("modifier_set", "")
    for face in room.items("faces"):
        _face(face, model, own)
    _shades(room, model, own)


def _face(face: Item, model: _Model, room_set: str) -> None:
    if _twin_seen(face, model):
        return
    kind = face.text("face_type", "Wall")
    outdoors = face.item("boundary_condition").text("type", "Outdoors") == "Outdoors"
    holes = []
    for aperture in face.items("apertures"):
        holes.append(aperture.item("geometry").points("boundary", 3) * model.scale)
        _aperture(aperture, model, room_set, outdoors=outdoors, on=kind)
    for door in face.items("doors"):
        holes.append(door.item("geometry").points("boundary", 3) * model.scale)
        _door(door, model, room_set)
    _shades(face, model, room_set)
    if kind == "AirBoundary":
        return
    if kind not in _SETS:
        raise face.wrong("face_type", "Wall, Floor, RoofCeiling or AirBoundary")
    side = "exterior" if outdoors else "interior"
    place = f"{_SETS[kind]}.{side}_modifier"
    modifier = model.modifiers.of(_radiance(face), place, room_set)
    geometry = face.item("geometry")
    loops = [geometry.points("boundary", 3), *geometry.loops("holes")]
    outline = seamed([loop * model.scale for loop in loops] + holes)
    model.put(outline, modifier, face.text("identifier"))


def _aperture(
    aperture: Item, model: _Model, room_set: str, *, outdoors: bool, on: str = "Wall"
) -> None:
    if _twin_seen(aperture, model):
        return
    _shades(aperture, model, room_set)
    key = "skylight" if on == "RoofCeiling" else "window"
    place = f"aperture_set.{key if outdoors else 'interior'}_modifier"
    if outdoors and aperture.value.get("is_operable") is True:
        place = "aperture_set.operable_modifier"
    own = _radiance(aperture)
    modifier = model.modifiers.of(own, place, room_set)
    name = aperture.text("identifier")
    states = _states(own, model, name)
    plain = not (states or model.all_windows or isinstance(modifier, BsdfModifier))
    if not outdoors or plain:
        if states:
            model.modifiers.unsupported.append(f'the states of inner aperture "{name}"')
            modifier = states[0][1]
        model.put(model.outline(aperture.item("geometry")), modifier, name)
        return

    _window(aperture, model, modifier, states)


def _window(
    opening: Item,
    model: _Model,
    modifier: Modifier,
    states: tuple[tuple[str, Modifier], ...] = (),
) -> None:
    # Coplanar apertures with the same modifiers form a window group
    outline = model.outline(opening.item("geometry"))[::-1]
    own = _radiance(opening).text("dynamic_group_identifier", "")
    group = (own or modifier_name(modifier), *plane_of(outline))
    model.groups.setdefault(group, []).append(outline)
    model.states.setdefault(group, states or ((modifier_name(modifier), modifier),))


def _states(own: Item, model: _Model, name: str) -> tuple[tuple[str, Modifier], ...]:
    found = []
    for state in own.items("states"):
        if state.value.get("shades"):
            model.modifiers.unsupported.append(f'the shades of states of "{name}"')
        if not state.text("modifier", ""):
            continue
        modifier = model.modifiers.called(state.text("modifier"), state)
        found.append((modifier_name(modifier), modifier))
    return tuple(found)


def _door(door: Item, model: _Model, room_set: str) -> None:
    if _twin_seen(door, model):
        return
    _shades(door, model, room_set)
    outdoors = door.item("boundary_condition").text("type", "Outdoors") == "Outdoors"
    side = "exterior" if outdoors else "interior"
    glass = "_glass" if door.value.get("is_glass") is True else ""
    place = f"door_set.{side}{glass}_modifier"
    modifier = model.modifiers.of(_radiance(door), place, room_set)
    if outdoors and glass and model.all_windows:
        _window(door, model, modifier)
        return
    name = door.text("identifier")
    model.put(model.outline(door.item("geometry")), modifier, name)


def _shades(owner: Item, model: _Model, room_set: str) -> None:
    for side in ("outdoor", "indoor"):
        inner = "interior" if side == "indoor" else "exterior"
        for shade in owner.items(f"{side}_shades"):
            _shade(shade, model, room_set, f"shade_set.{inner}_modifier")


def _shade(shade: Item, model: _Model, room_set: str, place: str) -> None:
    own, name = _radiance(shade), shade.text("identifier")
    modifier = model.modifiers.of(own, place, room_set)
    states = _states(own, model, name)
    if states:
        model.modifiers.unsupported.append(
            f'the states of shade "{name}": the first is used'
        )
        modifier = states[0][1]
    model.put(model.outline(shade.item("geometry")), modifier, name)


def _shade_mesh(mesh: Item, model: _Model) -> None:
    geometry = mesh.item("geometry")
    vertices = geometry.points("vertices", 3) * model.scale
    faces = geometry.value.get("faces")
    if not isinstance(faces, list):
        raise geometry.wrong("faces", "a list of lists of vertices")
    modifier = model.modifiers.of(_radiance(mesh), "context")
    for face in faces:
        known = isinstance(face, list) and len(face) >= 3
        if not known or not all(
            type(i) is int and 0 <= i < len(vertices) for i in face
        ):
            raise geometry.wrong("faces", "three or more numbers of vertices each")
        model.put(vertices[face], modifier, mesh.text("identifier"))


def _twin_seen(item: Item, model: _Model) -> bool:
    # Of two faces or openings that share a surface, the first is used
    name = item.text("identifier")
    boundary = item.item("boundary_condition")
    if boundary.text("type", "Outdoors") != "Surface":
        return False
    others = boundary.value.get("boundary_condition_objects")
    twin = others[0] if isinstance(others, list) and others else None
    model.seen.add(name)
    return isinstance(twin, str) and twin in model.seen


def _radiance(item: Item) -> Item:
    return item.item("properties").item("radiance")


def modifier_name(modifier: Modifier) -> str:
    """Return the name of a modifier."""
    return str(modifier.name)


def _windows(model: _Model) -> tuple[ApertureGroup, ...]:
    names = [str(group[0]) for group in model.groups]
    found, count = [], dict.fromkeys(names, 0)
    for group, polygons in model.groups.items():
        name = str(group[0])
        count[name] += 1
        label = name if names.count(name) == 1 else f"{name}.{count[name]}"
        states = model.states[group]
        up = next((m.up for _, m in states if isinstance(m, BsdfModifier)), None)
        plain = "".join(c if c.isalnum() or c in " .-_" else "-" for c in label)
        found.append(ApertureGroup(plain, tuple(polygons), up, states))
    return tuple(found)
