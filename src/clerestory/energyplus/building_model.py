"""Models of buildings for EnergyPlus, read from IDF text or epJSON.

EnergyPlus itself converts IDF text to epJSON, with the names of fields and the defaults
of its data dictionary.
"""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector, Vertices
from clerestory.checks import require
from clerestory.energyplus.engine_run import convert_to_json
from clerestory.files import is_file, read_text

# Class of windows whose corners the model gives
WINDOW_CLASS = "FenestrationSurface:Detailed"

# Numbers above this limit are no lengths or angles
_LARGEST = 1e12

Object = Mapping[str, Any]


@dataclass(frozen=True, eq=False)
class BuildingModel:
    """Objects of a model by class and name, as in an epJSON document."""

    objects: Mapping[str, Mapping[str, Object]]
    source: str = ""

    def of(self, kind: str) -> dict[str, Object]:
        """Objects of a class by name; neither is case-sensitive in EnergyPlus."""
        found: dict[str, Object] = {}
        for name, members in self.objects.items():
            if name.casefold() == kind.casefold():
                found |= members
        return found

    def find(self, name: str, *kinds: str) -> tuple[str, Object]:
        """Return an object of one of the classes, with its name as the model has it.

        Raises
        ------
        InputError : there is no such object; the message lists the names there are
        """
        known = {key: each for kind in kinds for key, each in self.of(kind).items()}
        for key, each in known.items():
            if key.casefold() == name.casefold():
                return key, each
        names = ", ".join(sorted(known)[:8]) or "none"
        require(
            False, f'no {kinds[0]} "{name}"; {names} in the model', file=self.source
        )
        raise AssertionError

    def constructions(self) -> list[str]:
        """Names of all constructions."""
        kinds = [k for k in self.objects if k.casefold().startswith("construction")]
        return [name for kind in kinds for name in self.objects[kind]]

    def window(self, name: str) -> "ModelWindow":
        """Return area and normal of a window with given corners.

        Raises
        ------
        InputError : there is no `FenestrationSurface:Detailed` of that name
        """
        found, one = self.find(name, WINDOW_CLASS)
        corners = self._corners(one)
        message = (
            f'{WINDOW_CLASS} "{found}" has {len(corners)} corners; 3 or 4 expected'
        )
        require(3 <= len(corners) <= 4, message, file=self.source)
        normal = self._outward(corners)
        area = float(np.linalg.norm(normal))
        require(area > 0, f'window "{found}" has no area', file=self.source)
        turn = np.radians(self._rotation_deg(one))
        east, north, up = normal / area
        turned = [
            east * np.cos(turn) + north * np.sin(turn),
            north * np.cos(turn) - east * np.sin(turn),
            up,
        ]
        wall = self.find(
            str(one.get("building_surface_name", "")), "BuildingSurface:Detailed"
        )[1]
        zone = str(wall.get("zone_name", ""))
        multiplier = self.number(one, "multiplier", 1.0)
        unturned = normal / area
        area *= multiplier
        return ModelWindow(found, zone, area, np.array(turned), corners, unturned)

    def _rotation_deg(self, window: Object) -> float:
        # Rotation of relative coordinates, clockwise from north; world coordinates have
        # none, but the building's north axis is ignored by EnergyPlus too
        rules = next(iter(self.of("GlobalGeometryRules").values()), {})
        if str(rules.get("coordinate_system", "")).casefold() == "world":
            return 0.0
        building = next(iter(self.of("Building").values()), {})
        wall = self.find(
            str(window.get("building_surface_name", "")), "BuildingSurface:Detailed"
        )[1]
        zone = self.find(str(wall.get("zone_name", "")), "Zone")[1]
        return self.number(building, "north_axis") + self.number(
            zone, "direction_of_relative_north"
        )

    def polygon(self, name: str, surface: Object) -> tuple[Vertices, Vector]:
        """Return corners of a `BuildingSurface:Detailed`, and its outward area vector.

        Raises
        ------
        InputError : fewer than three corners, or no area
        """
        axes = [f"vertex_{axis}_coordinate" for axis in "xyz"]
        given = surface.get("vertices", ())
        corners = np.array([[self.number(c, a) for a in axes] for c in given])
        message = f'surface "{name}" has {len(corners)} corners; 3 or more expected'
        require(len(corners) >= 3, message, file=self.source)
        outward = self._outward(corners)
        message = f'surface "{name}" has no area'
        require(np.linalg.norm(outward) > 0, message, file=self.source)
        return corners, outward

    def _outward(self, corners: Vertices) -> Vector:
        # Area vector; corners are in counterclockwise order seen from outdoors, or not
        rules = next(iter(self.of("GlobalGeometryRules").values()), {})
        order = str(rules.get("vertex_entry_direction", "")).casefold()
        edges = corners - corners[0]
        area = np.cross(edges[1:-1], edges[2:]).sum(axis=0) / 2
        return np.asarray(-area if order == "clockwise" else area)

    def _corners(self, one: Object) -> Float[np.ndarray, "corner 3"]:
        names = [
            [f"vertex_{k}_{axis}_coordinate" for axis in "xyz"] for k in range(1, 5)
        ]
        rows = [
            [self.number(one, name) for name in row]
            for row in names
            if all(name in one for name in row)
        ]
        return np.array(rows).reshape(-1, 3)

    def number(self, one: Object, name: str, default: float = 0.0) -> float:
        """Return a number of an object, or a default.

        Raises
        ------
        InputError : the value is no number, or too large
        """
        value = one.get(name, default)
        sound = isinstance(value, int | float) and abs(value) < _LARGEST
        message = f"{name} is {str(value)[:40]!r}; a number expected"
        require(sound, message, file=self.source)
        return float(value)


@dataclass(frozen=True, eq=False)
class ModelWindow:
    """Window of a model: zone, area [m²], and outward normal (east, north, up).

    `corners` are in the coordinates of the zone or of the world, as in the model [m];
    `outward` is the outward normal in the same coordinates.
    """

    name: str
    zone: str
    area: float
    normal: Vector
    corners: Vertices
    outward: Vector


def read_building_model(path: str | Path) -> BuildingModel:
    """Read a model from IDF text, or from epJSON if the name ends so.

    Raises
    ------
    InputError : the file cannot be read, EnergyPlus refuses it, or the engine, which
        converts IDF text, is not installed
    """
    path = Path(path)
    require(is_file(path), "no such file; a model of EnergyPlus expected", file=path)
    text = (
        read_text(path) if path.suffix.lower() == ".epjson" else convert_to_json(path)
    )
    try:
        found = json.loads(text)
    except (ValueError, RecursionError):
        found = None
    sound = isinstance(found, dict) and all(
        isinstance(members, dict)
        and all(isinstance(each, dict) for each in members.values())
        for members in found.values()
    )
    require(sound, "is not epJSON; objects by class and name expected", file=path)
    return BuildingModel(found, str(path))
