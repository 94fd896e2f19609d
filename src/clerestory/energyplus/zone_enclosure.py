"""Inside surfaces of a zone: polygons, areas and solar absorptances.

The solar absorptance of a surface is that of the innermost material of its
construction (EnergyPlus, *Input Output Reference*, group "Surface Construction
Elements").
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clerestory.array_types import Vector, Vertices
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.energyplus.building_model import WINDOW_CLASS, BuildingModel, Object

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
        inner = _innermost(building, construction)
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


def _innermost(building: BuildingModel, construction: str) -> Object:
    name, found = building.find(construction, "Construction")
    layers = [
        value
        for field, value in found.items()
        if field == "outside_layer" or field.startswith("layer_")
    ]
    require(layers, f'construction "{name}" has no layers', file=building.source)
    order = sorted(
        (int(field.split("_")[1]), str(value))
        for field, value in found.items()
        if field.startswith("layer_")
    )
    last = order[-1][1] if order else str(found["outside_layer"])
    return building.find(last, *_MATERIALS)[1]
