"""Inside surfaces of a zone: polygons, areas and solar absorptances.

The solar absorptance of a surface is that of the innermost material of its
construction (EnergyPlus, *Input Output Reference*, group "Surface Construction
Elements").
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from clerestory.array_types import Vector, Vertices
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.energyplus.building_model import WINDOW_CLASS, BuildingModel

# Objects by class and name
Objects = dict[str, dict[str, Any]]

_SURFACE = "BuildingSurface:Detailed"
_MATERIALS = ("Material", "Material:NoMass")

# Default of the field "Solar Absorptance" of materials
_ABSORPTANCE = 0.7

# Classes of surfaces and windows without corners, or with other fields
_OTHERS = (
    "Wall:Detailed",
    "RoofCeiling:Detailed",
    "Floor:Detailed",
    "Wall:Exterior",
    "Wall:Adiabatic",
    "Wall:Underground",
    "Wall:Interzone",
    "Roof",
    "Ceiling:Adiabatic",
    "Ceiling:Interzone",
    "Floor:GroundContact",
    "Floor:Adiabatic",
    "Floor:Interzone",
    "Window",
    "Window:Interzone",
    "GlazedDoor",
)


@dataclass(frozen=True, eq=False)
class InsideSurface:
    """Inside surface of a zone.

    Attributes
    ----------
    name, construction : names in the model
    vertices : corners of the whole surface, windows included [m]
    normal : unit vector into the zone
    absorptance : solar absorptance of the inside face
    """

    name: str
    construction: str
    vertices: Vertices
    normal: Vector
    absorptance: float

    __repr__ = brief

    @property
    def scheduled(self) -> str:
        """Name of the construction with a black inside face, see `black_inside`."""
        return f"{self.name} with given sun"


def inside_surfaces(building: BuildingModel, zone: str) -> list[InsideSurface]:
    """Return the inside surfaces of a zone.

    Raises
    ------
    InputError : the zone has no surface with corners, the model has surfaces of classes
        other than `BuildingSurface:Detailed`, or a material has no solar absorptance
    """
    other = next((kind for kind in _OTHERS if building.of(kind)), None)
    message = f"objects {other}; {_SURFACE} and {WINDOW_CLASS} expected"
    require(other is None, message, file=building.source)
    found = []
    for name, one in building.of(_SURFACE).items():
        if str(one.get("zone_name", "")).casefold() != zone.casefold():
            continue
        rows, outward = building.polygon(name, one)
        construction = str(one.get("construction_name", ""))
        inner = building.find(_layers(building, construction)[1][-1], *_MATERIALS)[1]
        absorptance = building.number(inner, "solar_absorptance", _ABSORPTANCE)
        normal = -outward / np.linalg.norm(outward)
        found.append(InsideSurface(name, construction, rows, normal, absorptance))
    message = f'zone "{zone}" without {_SURFACE}; its walls, floor and ceiling expected'
    require(found, message, file=building.source)
    return found


def other_windows(
    building: BuildingModel, surfaces: Sequence[InsideSurface], known: Sequence[str]
) -> list[str]:
    """Return names of the windows in surfaces that are not among the known ones."""
    walls = {surface.name.casefold() for surface in surfaces}
    names = {name.casefold() for name in known}
    return [
        name
        for name, one in building.of(WINDOW_CLASS).items()
        if str(one.get("building_surface_name", "")).casefold() in walls
        and name.casefold() not in names
    ]


def black_inside(building: BuildingModel, surface: InsideSurface) -> Objects:
    """Return objects that give a surface an inside face of solar absorptance 1.

    EnergyPlus distributes what inside faces reflect over the zone; with black faces,
    given radiation is absorbed where it is given. The outside face keeps its
    absorptance: a construction of one layer is divided into two. A surface of two zones
    keeps its construction, as both sides must have the same layers; its objects are
    none.
    """
    own, one = building.find(surface.name, _SURFACE)
    other = str(one.get("outside_boundary_condition_object", ""))
    if other.casefold() not in ("", own.casefold()):
        return {}
    title, layers = _layers(building, surface.construction)
    materials = {kind: building.of(kind) for kind in _MATERIALS}
    inner, _ = building.find(layers[-1], *_MATERIALS)
    kind = next(k for k, members in materials.items() if inner in members)
    fields = dict(materials[kind][inner])
    added: Objects = {kind: {}}
    if len(layers) == 1:
        size = "thickness" if kind == "Material" else "thermal_resistance"
        fields[size] = building.number(fields, size) / 2
        layers = [f"{title} half", layers[-1]]
        added[kind][layers[0]] = dict(fields)
    layers[-1] = f"{title} inside"
    added[kind][layers[-1]] = {**fields, "solar_absorptance": 1.0}
    named = {"outside_layer": layers[0]}
    named |= {f"layer_{n}": layer for n, layer in enumerate(layers[1:], 2)}
    added["Construction"] = {surface.scheduled: named}
    added[_SURFACE] = {own: {**one, "construction_name": surface.scheduled}}
    return added


def _layers(building: BuildingModel, construction: str) -> tuple[str, list[str]]:
    name, found = building.find(construction, "Construction")
    outer = found.get("outside_layer")
    require(outer, f'construction "{name}" has no layers', file=building.source)
    order = sorted(
        (int(field.split("_")[1]), str(value))
        for field, value in found.items()
        if field.startswith("layer_")
    )
    return name, [str(outer), *(layer for _, layer in order)]
