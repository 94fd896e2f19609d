"""BSDFs by the name of a file, or by that of a built-in product, `library:NAME`.

Built-in BSDFs are computed from their recipes when they are used, in less than a
second, by the layer models of `glazing`: no files are stored. The same name gives the
same numbers on every machine, up to rounding.
"""

import difflib
import math
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_writer import usual_digits, write_bsdf
from clerestory.checks import require
from clerestory.constants import LIBRARY_PREFIX
from clerestory.errors import InputError
from clerestory.glazing.layer import Layer
from clerestory.glazing.stack import stack_layers
from clerestory.gonio.layer_file import read_layer
from clerestory.library.catalogue import RECIPES

# One layer system of a name, most of them in one name, and its longest text in an error
_PART = re.compile(r"([a-z0-9-]+)(?:@(-?\d{1,2}))?", re.ASCII)
_MOST, _SHOWN = 4, 60


def read_bsdf(path: str | Path) -> Bsdf:
    """Return a BSDF from a file or, by `library:NAME`, from the built-in library.

    Files are XML files with matrices or tensor trees (WINDOW, genBSDF), or fits of
    measurements (.nc). Harmless irregularities of a file (text before the XML, a
    repeated block, slightly negative values) are listed in `Bsdf.notes`. `clerestory
    bsdf library` lists the names; `@45` gives the tilt of slats in degrees, and `+`
    joins layers from outdoors to indoors.

    Raises
    ------
    InputError : the file is not a BSDF file, is damaged or has no data; no product has
        the name

    Warns
    -----
    ClerestoryWarning : the scattered flux exceeds the incident flux

    Examples
    --------
    >>> glazing = read_bsdf("library:double-clear-6")
    >>> round(float(glazing.diffuse("transmission_front")), 2)
    0.68
    >>> behind = read_bsdf("library:double-clear-6+venetian-25-white@45")
    >>> behind.source
    'library:double-clear-6+venetian-25-white@45'
    """
    return library_bsdf(str(path)) if is_library_name(path) else read_layer(path)


def is_library_name(path: str | Path) -> bool:
    """Whether a path is the name of a built-in BSDF, `library:…`."""
    return str(path).startswith(LIBRARY_PREFIX)


@contextmanager
def bsdf_file(path: str | Path) -> Iterator[Path]:
    """Give the path of a BSDF file; for a built-in product, of a temporary file."""
    if not is_library_name(path):
        yield Path(path)
        return
    with TemporaryDirectory() as folder:
        file = Path(folder) / "library.xml"
        bsdf = library_bsdf(str(path))
        write_bsdf(file, bsdf, digits=usual_digits(bsdf))
        yield file


@lru_cache(maxsize=64)
def library_bsdf(name: str) -> Bsdf:
    """Return a built-in BSDF by name, with or without `library:` before it."""
    given = name.removeprefix(LIBRARY_PREFIX)
    layers = library_layers(given)
    bsdf = stack_layers(layers, method="bands", name=given).bsdf
    product = replace(bsdf.product, manufacturer="Clerestory library")
    return replace(bsdf, product=product, source=f"{LIBRARY_PREFIX}{given}")


def library_layers(name: str) -> Sequence[Layer]:
    """Return the layers of a built-in BSDF, from outdoors to indoors."""
    parts = name.removeprefix(LIBRARY_PREFIX).split("+", maxsplit=_MOST)
    require(
        len(parts) <= _MOST,
        f"{_quoted(name)} joins more than {_MOST} products; fewer expected",
    )
    return [layer for part in parts for layer in _layers(part)]


def _layers(part: str) -> tuple[Layer, ...]:
    match = _PART.fullmatch(part)
    if match is None or match[1] not in RECIPES:
        near = difflib.get_close_matches(part[:_SHOWN].split("@")[0], RECIPES, n=3)
        such = f"one such as {', '.join(near)}" if near else "another name"
        raise InputError(
            f"no built-in BSDF is named {_quoted(part)}; {such} expected"
            " (`clerestory bsdf library` lists all)"
        )
    recipe, tilt = RECIPES[match[1]], match[2]
    require(
        recipe.tilts or tilt is None,
        f"{_quoted(part)} has a tilt; {match[1]} has no slats to tilt",
    )
    require(
        tilt is None or abs(int(tilt)) <= 90,
        f"tilt of {_quoted(part)}; a whole number from -90 to 90 degrees expected",
    )
    return recipe.layers(math.radians(int(tilt or 0)))


def _quoted(text: str) -> str:
    return repr(text if len(text) <= _SHOWN else f"{text[:_SHOWN]}…")
