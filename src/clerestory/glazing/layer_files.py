"""Readers of glazing and shading layers, and of folders of products."""

import re
import warnings
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.checks import require
from clerestory.documents import read_json
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.igsdb import Product
from clerestory.glazing.layer import Glass, Layer
from clerestory.glazing.lbnl_optics import read_optics_file
from clerestory.glazing.pane import Pane
from clerestory.glazing.shade_parameters import igsdb_shade

# File name extensions of LBNL Optics and of manufacturers.
_OPTICS = re.compile(r"\.(dat|usr|txt|[a-z]{3})$", re.IGNORECASE)
_IGNORED = {".csv", ".md", ".py", ".std", ".ssp", ".dsp", ".loc", ".wvl", ".epw"}

# Sum of transmittance and reflectance above which a warning is given.
_MOST_SCATTERED = 1.01


def read_layer(path: str | Path) -> Layer:
    """Return the layer that a file describes.

    `.json` is a product of the IGSDB (glass, or a venetian, perforated or woven shade
    with its geometry), `.xml` a BSDF, any other file glass in the LBNL Optics format.

    Raises
    ------
    InputError : the file is of another format, or damaged
    """
    if Path(path).suffix.lower() == ".xml":
        return BsdfLayer(read_bsdf(path))
    product = _product(path)
    with located(file=path):
        if product is None or product.material is None:
            return Glass(_pane(path, product))
        if product.geometry is None:
            raise InputError("the shade has no geometry; extra_data.geometry expected")
        return igsdb_shade(product.geometry, path).layer(_pane(path, product))


def read_pane(path: str | Path) -> Pane:
    """Return the glass, or the shade material, that a file describes."""
    return _pane(path, _product(path))


def _product(path: str | Path) -> Product | None:
    return read_json(path, Product) if Path(path).suffix.lower() == ".json" else None


def _pane(path: str | Path, product: Product | None) -> Pane:
    with located(file=path):
        pane = read_optics_file(path) if product is None else product.pane(path)
    shares = pane.at(pane.wavelength_nm)
    most = 1 - np.minimum(shares.absorption("front"), shares.absorption("back"))
    if most.max() > _MOST_SCATTERED:
        at = pane.wavelength_nm[int(np.argmax(most))]
        share = f"{pane.name!r} scatters {most.max():.3f} times the incident flux"
        message = f"{path}: {share} at {at:g} nm; at most 1 expected"
        warnings.warn(message, ClerestoryWarning, stacklevel=4)
    return pane


@final
@dataclass(frozen=True)
class Entry:
    """A product in a catalogue: name and NFRC number as stated in the file.

    `problem`: reason why the file cannot be read; empty if it can be read.
    """

    name: str
    nfrc_id: int | None
    path: Path
    problem: str = ""


def read_catalogue(folder: str | Path) -> tuple[Entry, ...]:
    """Return the products in a folder, sorted by name, including unreadable files."""
    folder = Path(folder)
    require(folder.is_dir(), "a folder of products expected", file=folder)
    files = [
        path
        for path in sorted(folder.iterdir())
        if path.is_file()
        and path.suffix.lower() not in _IGNORED
        and (path.suffix.lower() in (".json", ".xml") or _OPTICS.search(path.name))
    ]
    entries = [_entry(path) for path in files]
    message = "no product in this folder; files .json, .xml or .dat expected"
    require(entries, message, file=folder)
    return tuple(sorted(entries, key=lambda entry: (entry.name.lower(), entry.path)))


def _entry(path: Path) -> Entry:
    try:
        layer = read_layer(path)
    except InputError as error:
        return Entry(path.stem, None, path, str(error))
    number = layer.material.nfrc_id if isinstance(layer, Glass) else None
    return Entry(layer.name, number, path)
