"""Material maps (.toml): materials for the material names in a mesh file.

file = "materials.rad"          # optional: scene file with materials used below
scale = 0.001                   # metres per unit of the mesh file
up = "y"                        # axis of the mesh file that points up

[materials]
Oak = { reflectance = [0.5, 0.38, 0.26], specularity = 0.01, roughness = 0.1 }
Pane = { transmissivity = 0.87 }
Wall = "painted_wall"           # a material of materials.rad
"*" = { reflectance = 0.5 }     # all other names
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal, final

import numpy as np
from pydantic import Field

from clerestory.documents import Table, read_toml
from clerestory.errors import InputError
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Glass, Material, Plastic

_Share = Annotated[float, Field(ge=0, le=1)]
_Colour = _Share | Annotated[list[_Share], Field(min_length=3, max_length=3)]


class _PlasticTable(Table):
    reflectance: _Colour
    specularity: _Share = 0.0
    roughness: _Share = 0.0


class _GlassTable(Table):
    transmissivity: _Colour
    index: float = Field(1.52, ge=1, le=4)


class _MapFile(Table):
    file: str = ""
    scale: float = Field(1.0, gt=0)
    up: Literal["y", "z"] | None = None
    materials: dict[str, str | _PlasticTable | _GlassTable]


@final
@dataclass(frozen=True, eq=False)
class MaterialMap:
    """Materials for the material names in a mesh file; "*" for all other names.

    `scale` is in metres per unit of the mesh file. `up` is the axis that points up;
    None: the axis of the file format.
    """

    materials: Mapping[str, Material]
    scale: float = 1.0
    up: Literal["y", "z"] | None = None


def read_material_map(path: str | Path) -> MaterialMap:
    """Return the material map in a TOML file; relative paths begin at its folder."""
    path = Path(path)
    given = read_toml(path, _MapFile)
    known = read_rad(path.parent / given.file).materials if given.file else {}
    found: dict[str, Material] = {}
    for name, value in given.materials.items():
        if isinstance(value, str):
            if value not in known:
                raise InputError(
                    f'no material "{value}" in {given.file or "a file"}', file=path
                )
            found[name] = known[value]
        else:
            found[name] = _material(name, value)
    return MaterialMap(found, given.scale, given.up)


def _material(name: str, table: _PlasticTable | _GlassTable) -> Material:
    plain = "_".join(name.split()) if name != "*" else "other"
    if isinstance(table, _GlassTable):
        return Glass(plain, _colour(table.transmissivity), table.index)
    gloss = table.specularity, table.roughness
    return Plastic(plain, _colour(table.reflectance), *gloss)


def _colour(value: float | list[float]) -> np.ndarray:
    return np.broadcast_to(np.array(value, dtype=float), 3).copy()
