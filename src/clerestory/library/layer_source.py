"""Layers of glazing by the name of a file, or by that of a built-in product."""

from pathlib import Path

from clerestory.checks import require
from clerestory.glazing import layer_files
from clerestory.glazing.layer import Layer
from clerestory.library.bsdf_source import is_library_name, library_layers


def read_layers(path: str | Path) -> tuple[Layer, ...]:
    """Return the layers of a file or of a built-in product, from outdoors to indoors.

    A file describes one layer; a built-in product, `library:NAME`, may have several.

    Raises
    ------
    InputError : the file is of another format, or damaged; no product has the name
    """
    if is_library_name(path):
        return tuple(library_layers(str(path)))
    return (layer_files.read_layer(path),)


def read_layer(path: str | Path) -> Layer:
    """Return the layer that a file describes, or a built-in product of one layer.

    `.json` is a product of the IGSDB (glass, or a venetian, perforated or woven shade
    with its geometry), `.xml` a BSDF, `library:NAME` a built-in product, any other file
    glass in the LBNL Optics format.

    Raises
    ------
    InputError : the file is of another format, or damaged; no product has the name, or
        the product has several layers

    Examples
    --------
    >>> read_layer("library:single-clear-6").thickness
    0.006
    """
    layers = read_layers(path)
    require(
        len(layers) == 1,
        f"{path} has {len(layers)} layers; one expected (`read_layers` returns all)",
    )
    return layers[0]
