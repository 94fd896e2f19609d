"""Schema of the JSON members of honeybee models that the reader uses.

Reference: ladybug-tools, honeybee-schema, the JSON schema of honeybee models.
"""

from collections.abc import Iterator
from typing import Annotated, Any, Literal

import numpy as np
from jaxtyping import Float
from pydantic import AliasPath, ConfigDict, Field

from clerestory.documents import Item, Number

_Fraction = Annotated[Number, Field(ge=0, le=1)]
_Positive = Annotated[Number, Field(ge=0)]
_Point = tuple[Number, Number, Number]
_Loop = Annotated[tuple[_Point, ...], Field(min_length=3)]
_Polygon = Annotated[tuple[Annotated[int, Field(ge=0)], ...], Field(min_length=3)]


def _at(path: str, *default: object) -> Any:
    # Member of a nested object, at a path such as "geometry.boundary"
    first = default[0] if default else ...
    return Field(first, validation_alias=AliasPath(*path.split(".")))


class State(Item):
    """A dynamic state of an aperture or a shade."""

    modifier: str = ""
    shades: tuple[object, ...] = ()
    vmtx_geometry: object = None
    dmtx_geometry: object = None


class Part(Item):
    """A face, aperture, door or shade."""

    identifier: str
    boundary: _Loop = _at("geometry.boundary")
    holes: tuple[_Loop, ...] | None = _at("geometry.holes", None)
    modifier: str | None = _at("properties.radiance.modifier", None)
    states: tuple[State, ...] | None = _at("properties.radiance.states", None)
    group: str | None = _at("properties.radiance.dynamic_group_identifier", None)
    exposure: str | None = _at("boundary_condition.type", "Outdoors")
    twins: tuple[str, ...] | None = _at(
        "boundary_condition.boundary_condition_objects", None
    )
    outdoor_shades: "tuple[Part, ...]" = ()
    indoor_shades: "tuple[Part, ...]" = ()
    is_operable: bool = False
    is_glass: bool = False
    is_detached: bool = False
    face_type: Literal["Wall", "Floor", "RoofCeiling", "AirBoundary"] = "Wall"
    apertures: "tuple[Part, ...]" = ()
    doors: "tuple[Part, ...]" = ()

    def loops(self) -> list[Float[np.ndarray, "_ 3"]]:
        """Corners of the outline, then of each hole, in model units."""
        return [np.array(loop) for loop in (self.boundary, *(self.holes or ()))]


class ShadeMesh(Item):
    """A shade given as a mesh."""

    identifier: str
    vertices: _Loop = _at("geometry.vertices")
    faces: tuple[_Polygon, ...] = _at("geometry.faces")
    modifier: str | None = _at("properties.radiance.modifier", None)
    is_detached: bool = True


class Room(Item):
    """A room with its faces."""

    identifier: str = ""
    display_name: str = ""
    multiplier: Number = 1.0
    faces: tuple[Part, ...] = ()
    modifier_set: str | None = _at("properties.radiance.modifier_set", None)
    program: object = _at("properties.energy.program_type", None)
    outdoor_shades: tuple[Part, ...] = ()
    indoor_shades: tuple[Part, ...] = ()


class ModifierItem(Item):
    """A material or a BSDF, with the members of all types; missing members are 0."""

    identifier: str
    type: str
    modifier: object = None
    r_reflectance: _Fraction = 0.0
    g_reflectance: _Fraction = 0.0
    b_reflectance: _Fraction = 0.0
    r_transmissivity: _Fraction = 0.0
    g_transmissivity: _Fraction = 0.0
    b_transmissivity: _Fraction = 0.0
    r_emittance: _Positive = 0.0
    g_emittance: _Positive = 0.0
    b_emittance: _Positive = 0.0
    specularity: _Fraction = 0.0
    roughness: _Fraction = 0.0
    refraction_index: _Positive = 1.52
    transmitted_diff: _Fraction = 0.0
    transmitted_spec: _Fraction = 0.0
    max_radius: Number = 0.0
    thickness: Number = 0.0
    transform: object = None
    up_orientation: _Point = (0.0, 0.0, 1.0)
    bsdf_data: str = ""

    def colour(self, word: str) -> Float[np.ndarray, "3"]:
        """Red, green and blue of a member such as `reflectance`."""
        return np.array([getattr(self, f"{channel}_{word}") for channel in "rgb"])


class ModifierSet(Item):
    """Modifiers, and modifier names by kind of surface (in `model_extra`)."""

    model_config = ConfigDict(extra="allow")

    identifier: str = ""
    modifiers: tuple[ModifierItem, ...] = ()


class Sensor(Item):
    """Position and direction of a sensor."""

    pos: _Point
    dir: _Point


class Grid(Item):
    """A sensor grid; files of results are named after its group and identifier."""

    identifier: str
    display_name: str = ""
    room_identifier: str = ""
    group_identifier: str = ""
    sensors: tuple[Sensor, ...] = ()


class ViewItem(Item):
    """A view; sizes are angles [deg] or, for parallel views, lengths."""

    identifier: str
    display_name: str = ""
    view_type: Literal["v", "l", "h", "a", "s", "c"] = "v"
    position: _Point
    direction: _Point
    up_vector: _Point = (0.0, 0.0, 1.0)
    h_size: Number = 60.0
    v_size: Number = 60.0
    shift: Number = 0.0
    lift: Number = 0.0
    fore_clip: _Positive = 0.0
    aft_clip: _Positive = 0.0


class Radiance(Item):
    """Radiance properties of the model."""

    global_modifier_set: ModifierSet = ModifierSet()
    modifiers: tuple[ModifierItem, ...] = ()
    modifier_sets: tuple[ModifierSet, ...] = ()
    sensor_grids: tuple[Grid, ...] = ()
    views: tuple[ViewItem, ...] = ()


class Model(Item):
    """A honeybee model: the root object of the file."""

    type: Literal["Model"] = "Model"
    identifier: str = "model"
    display_name: str = ""
    tolerance: _Positive = 0.01
    extensions: dict[str, object] = Field({}, validation_alias="properties")
    units: Literal["Meters", "Millimeters", "Centimeters", "Feet", "Inches"] = "Meters"
    radiance: Radiance = _at("properties.radiance", Radiance())
    rooms: tuple[Room, ...] = ()
    orphaned_faces: tuple[Part, ...] = ()
    orphaned_apertures: tuple[Part, ...] = ()
    orphaned_doors: tuple[Part, ...] = ()
    orphaned_shades: tuple[Part, ...] = ()
    shade_meshes: tuple[ShadeMesh, ...] = ()


def ignored_members(root: Model) -> Iterator[str]:
    """Yield descriptions of the members of a model that are not read."""
    for name in root.extensions:
        if name not in ("radiance", "type"):
            yield f"the {name} properties of the model"
    for room in root.rooms:
        if room.multiplier != 1:
            named = f'the multiplier {room.multiplier:g} of room "{room.identifier}"'
            yield f"{named}: it is modelled once"
    for grid in root.radiance.sensor_grids:
        if not grid.sensors:
            yield f'sensor grid "{grid.identifier}": it has no sensors'
