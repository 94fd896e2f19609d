"""Products of IFC files with their triangles, read by ifcopenshell in a process.

ifcopenshell is a C++ library (extra `ifc`). It reads the file in a process of its own,
so that a damaged file can neither end nor block the caller.
"""

import importlib.util
import os
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Annotated, final

import numpy as np
from jaxtyping import Float, Int
from pydantic import Field

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.documents import Item, Number, parse_json
from clerestory.errors import ClerestoryError, InputError
from clerestory.escaping import printable
from clerestory.files import read_bytes
from clerestory.formats import ifc_extraction

# Time limit: a base, and an addition for each megabyte of the file [s]
_BASE_S, _PER_MEGABYTE_S = 60.0, 60.0

# Largest number of characters of a reason in a message
_LONGEST = 200

_Count = Annotated[int, Field(ge=0)]


class Style(Item):
    """Surface style of triangles: name, and transparency from 0 to 1 as displayed."""

    name: str = ""
    transparency: Number = 0.0


class Product(Item):
    """A product of an IFC file: an element, a space or a site.

    Attributes
    ----------
    kind, type : IFC class, such as `IfcWindow`, and predefined type
    numbers : numbers in property sets of the product and its materials, by name
    opening : whether the triangles are those of the opening that the product fills
    vertices, triangles : numbers of vertices and triangles
    """

    guid: str = ""
    kind: str
    type: str = ""
    name: str = ""
    long_name: str = ""
    materials: tuple[str, ...] = ()
    numbers: dict[str, Number] = Field(default_factory=dict)
    opening: bool = False
    vertices: _Count = 0
    triangles: _Count = 0
    styles: tuple[Style, ...] = ()


class Site(Item):
    """Position of the site: coordinates [°], positive north and east, elevation [m]."""

    latitude_deg: Number
    longitude_deg: Number
    elevation: Number = 0.0


class Content(Item):
    """Content of an IFC file; `north` is a direction in the plane of the model.

    `products` have triangles; those without are in `without_surfaces`.
    """

    schema_name: str = Field("", alias="schema")
    name: str = ""
    north: tuple[Number, Number] | None = None
    site: Site | None = None
    products: tuple[Product, ...] = ()
    without_surfaces: tuple[Product, ...] = ()


@final
@dataclass(frozen=True, eq=False)
class Mesh:
    """Triangles of a product, counter-clockwise as seen from outside.

    Attributes
    ----------
    product : the product
    vertices : positions [m]
    faces : indices of the vertices of each triangle
    style : index of the style of each triangle; -1 without a style
    part : number of the geometric item, such as an extrusion, of each triangle
    """

    product: Product
    vertices: Float[np.ndarray, "vertex 3"]
    faces: Int[np.ndarray, "triangle 3"]
    style: Int[np.ndarray, " triangle"]
    part: Int[np.ndarray, " triangle"]

    __repr__ = brief


@final
@dataclass(frozen=True, eq=False)
class IfcContent:
    """Content of an IFC file, and the triangles of its products."""

    content: Content
    meshes: tuple[Mesh, ...]

    __repr__ = brief


def read_products(path: str | Path, *, seconds: float | None = None) -> IfcContent:
    """Read the products of an IFC file with their triangles, in metres.

    Parameters
    ----------
    seconds : time limit [s]; None: a minute, and a minute for each megabyte

    Raises
    ------
    InputError : the file is not an IFC file, ends the process that reads it, or takes
        longer than the time limit
    ClerestoryError : ifcopenshell is not installed
    """
    if importlib.util.find_spec("ifcopenshell") is None:
        raise ClerestoryError(
            "IFC files require ifcopenshell, which is not installed; pip install"
            " 'clerestory[ifc]'"
        )
    data = read_bytes(path)
    for place, text, word in (
        ("start", data[:1000], b"ISO-10303-21;"),
        ("end", data[-1000:], b"END-ISO-10303-21;"),
    ):
        message = (
            f'no IFC file, or incomplete; "{word.decode()}" expected at its {place}'
        )
        require(word in text, message, file=path)
    limit = seconds or _BASE_S + _PER_MEGABYTE_S * len(data) / 1e6
    with TemporaryDirectory() as name:
        folder = Path(name)
        (folder / "model.ifc").write_bytes(data)
        _extract(folder, path, limit)
        text = (folder / ifc_extraction.PRODUCTS).read_bytes()
        content = parse_json(text, Content, file=path)
        with np.load(folder / ifc_extraction.TRIANGLES) as arrays:
            return IfcContent(content, _meshes(content.products, dict(arrays), path))


def _extract(folder: Path, path: str | Path, limit: float) -> None:
    command = [sys.executable, "-P", ifc_extraction.__file__, "model.ifc", "."]
    search = os.pathsep.join(filter(None, sys.path))
    try:
        child = subprocess.run(
            command,
            cwd=folder,
            env={**os.environ, "PYTHONPATH": search, "OMP_NUM_THREADS": "1"},
            stdin=subprocess.DEVNULL,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.PIPE,
            timeout=limit,
            check=False,
        )
    except subprocess.TimeoutExpired as error:
        message = f"was not read by ifcopenshell within {limit:.0f} s"
        raise InputError(f"{message}; an undamaged file expected", file=path) from error
    if child.returncode:
        lines = child.stderr.decode(errors="replace").strip().splitlines()
        reason = printable(lines[-1])[:_LONGEST] if lines else "no reason given"
        if child.returncode != ifc_extraction.UNREADABLE:
            status = f"status {child.returncode}"
            reason = f"the process that reads the file ended with {status}"
        message = f"cannot be read by ifcopenshell: {reason}"
        raise InputError(f"{message}; an undamaged file expected", file=path)


def _meshes(
    products: tuple[Product, ...], arrays: dict[str, np.ndarray], path: str | Path
) -> tuple[Mesh, ...]:
    if not products:
        return ()
    vertices = np.asarray(arrays["vertices"], dtype=float)
    sound = "positions that are not finite numbers; finite numbers expected"
    require(np.isfinite(vertices).all(), sound, file=path)
    names = ("faces", "styles", "parts")
    places = np.cumsum([product.vertices for product in products])[:-1]
    cuts = np.cumsum([product.triangles for product in products])[:-1]
    split = (np.split(arrays[name], cuts) for name in names)
    parts = zip(products, np.split(vertices, places), *split, strict=True)
    return tuple(Mesh(*part) for part in parts)
