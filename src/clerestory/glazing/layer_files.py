"""Readers of glazing and shading layers, and of folders of products."""

import math
import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.errors import InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.igsdb import load_product, pane_of
from clerestory.glazing.layer import Glass, Layer
from clerestory.glazing.lbnl_optics import read_optics_file
from clerestory.glazing.pane import Pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.venetian import VenetianBlind

_MILLIMETRE = 1e-3

# File name extensions of LBNL Optics and of manufacturers.
_OPTICS = re.compile(r"\.(dat|usr|txt|[a-z]{3})$", re.IGNORECASE)
_IGNORED = {".csv", ".md", ".py", ".std", ".ssp", ".dsp", ".loc", ".wvl", ".epw"}


def read_layer(path: str | Path) -> Layer:
    """Return the layer that a file describes.

    `.json` is a product of the IGSDB (glass, or a venetian, perforated or woven shade
    with its geometry), `.xml` a BSDF, any other file glass in the LBNL Optics format.

    Raises
    ------
    InputError : the file is of another format, or damaged
    """
    ending = Path(path).suffix.lower()
    if ending == ".xml":
        return BsdfLayer(read_bsdf(path))
    if ending == ".json":
        return _igsdb_layer(load_product(path), path)
    return Glass(read_optics_file(path))


def read_pane(path: str | Path) -> Pane:
    """Return the glass, or the shade material, that a file describes."""
    if Path(path).suffix.lower() == ".json":
        product = load_product(path)
        composition = product.get("composition")
        return pane_of(_child(composition, path) if composition else product, path)
    return read_optics_file(path)


@final
@dataclass(frozen=True)
class Entry:
    """A product in a catalogue.

    Attributes
    ----------
    name, nfrc_id : product name and NFRC number stated in the file
    path : path of the product file
    problem : reason why the file cannot be read; empty if it can be read
    """

    name: str
    nfrc_id: int | None
    path: Path
    problem: str = ""


def read_catalogue(folder: str | Path) -> tuple[Entry, ...]:
    """Return the products in a folder, sorted by name, including unreadable files."""
    folder = Path(folder)
    if not folder.is_dir():
        raise InputError("a folder of products expected", file=folder)
    files = [
        path
        for path in sorted(folder.iterdir())
        if path.is_file()
        and path.suffix.lower() not in _IGNORED
        and (path.suffix.lower() in (".json", ".xml") or _OPTICS.search(path.name))
    ]
    entries = [_entry(path) for path in files]
    if not entries:
        raise InputError(
            "no product in this folder; files .json, .xml or .dat expected", file=folder
        )
    return tuple(sorted(entries, key=lambda entry: (entry.name.lower(), entry.path)))


def find_layer(folder: str | Path, wanted: str) -> Layer:
    """Return the layer of a catalogue with a given name, NFRC number or file name."""
    word = wanted.strip().lower()
    found = [
        entry
        for entry in read_catalogue(folder)
        if word in (entry.name.lower(), str(entry.nfrc_id), entry.path.name.lower())
        or word == entry.path.stem.lower()
    ]
    if len(found) != 1:
        what = "no product" if not found else f"{len(found)} products"
        raise InputError(
            f"{what} called {wanted!r}; the name, NFRC number or file name of one"
            " product expected",
            file=folder,
        )
    return read_layer(found[0].path)


def _entry(path: Path) -> Entry:
    try:
        layer = read_layer(path)
    except InputError as error:
        return Entry(path.stem, None, path, str(error))
    number = layer.material.nfrc_id if isinstance(layer, Glass) else None
    return Entry(layer.name, number, path)


def _igsdb_layer(product: dict[str, Any], path: str | Path) -> Layer:
    composition = product.get("composition")
    if not composition:
        return Glass(pane_of(product, path))
    geometry = _geometry(composition, path)
    material = pane_of(_child(composition, path), path)

    def length(key: str) -> float:
        return _number(geometry, key, path) * _MILLIMETRE

    try:
        if "slat_width" in geometry:
            slats = SlatGeometry(
                width=length("slat_width"),
                spacing=length("slat_spacing"),
                tilt=math.radians(_number(geometry, "slat_tilt", path)),
                curvature_radius=length("slat_curvature"),
                segments=int(geometry.get("number_segments") or 5),
            )
            return VenetianBlind(material, slats)
        if "thread_diameter" in geometry:
            return WovenShade(
                material,
                thread_diameter=length("thread_diameter"),
                thread_spacing=length("thread_spacing"),
            )
        if "perforation_type" in geometry:
            return _screen(material, geometry, length)
    except (InputError, TypeError, ValueError) as error:
        reason = error.message if isinstance(error, InputError) else str(error)
        raise InputError(f"{product.get('name')!r}: {reason}", file=path) from error
    raise InputError(
        f"{product.get('name')!r} has a geometry of {', '.join(geometry) or 'nothing'};"
        " slats, threads or perforations expected",
        file=path,
    )


def _screen(material: Pane, geometry: dict[str, Any], length: Any) -> PerforatedScreen:
    kind = str(geometry["perforation_type"]).lower()
    if kind not in ("circular", "square", "rectangular"):
        raise InputError(
            f"perforation_type {kind[:40]!r}; circular, square or rectangular expected"
        )
    width = length("dimension_x")
    height = length("dimension_y") if kind == "rectangular" else width
    return PerforatedScreen(
        material,
        "circular" if kind == "circular" else "rectangular",
        (length("spacing_x"), length("spacing_y")),
        (width, height),
    )


def _child(composition: Any, path: str | Path) -> dict[str, Any]:
    try:
        child = composition[0]["child_product"]
    except (KeyError, IndexError, TypeError) as error:
        raise InputError("composition without a child_product", file=path) from error
    if not isinstance(child, dict):
        raise InputError("child_product is not a JSON object", file=path)
    return child


def _geometry(composition: Any, path: str | Path) -> dict[str, Any]:
    try:
        geometry = composition[0]["extra_data"]["geometry"]
    except (KeyError, IndexError, TypeError) as error:
        raise InputError(
            "shade without a geometry in its extra_data", file=path
        ) from error
    if not isinstance(geometry, dict):
        raise InputError("geometry is not a JSON object", file=path)
    return geometry


def _number(geometry: dict[str, Any], key: str, path: str | Path) -> float:
    try:
        number = float(geometry[key])
    except (KeyError, TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InputError(
            f"{key} is {str(geometry.get(key))[:40]!r}; a number expected", file=path
        )
    return number
