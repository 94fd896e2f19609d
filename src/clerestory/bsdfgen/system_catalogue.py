"""Catalogue of parametric shading systems, created from command lines or TOML files."""

import inspect
import math
from collections.abc import Callable, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import Any

from clerestory.bsdfgen.fabric import fabric
from clerestory.bsdfgen.film_geometry import mirrored_channels, prismatic
from clerestory.bsdfgen.flat_panes import clear_pane, diffuse_pane
from clerestory.bsdfgen.screen_geometry import perforated, woven
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.documents import toml_tables
from clerestory.errors import InputError
from clerestory.files import read_text

SYSTEMS: Mapping[str, Callable[..., System]] = MappingProxyType(
    {
        "venetian": venetian,
        "microlouvre": microlouvre,
        "prismatic": prismatic,
        "mirrored_channels": mirrored_channels,
        "perforated": perforated,
        "woven": woven,
        "fabric": fabric,
        "diffuse_pane": diffuse_pane,
        "clear_pane": clear_pane,
    }
)


def make_system(kind: str, values: Mapping[str, Any]) -> System:
    """Create a parametric system from its kind and its parameters.

    >>> make_system("fabric", {"openness": 0.03, "reflectance": 0.5}).product.name
    'Fabric, 3.0% open'
    """
    if kind not in SYSTEMS:
        raise InputError(
            f"unknown system {kind!r}; one of {', '.join(SYSTEMS)} expected"
        )
    parameters = inspect.signature(SYSTEMS[kind]).parameters
    unknown = sorted(set(values) - set(parameters))
    if unknown:
        raise InputError(
            f"{kind} has no parameter {unknown[0]!r}; one of {', '.join(parameters)}"
            " expected"
        )
    needed = [n for n, p in parameters.items() if p.default is p.empty]
    missing = [n for n in needed if n not in values]
    if missing:
        raise InputError(
            f"{kind} lacks the parameter {missing[0]!r}; {', '.join(needed)} expected"
        )
    for name, value in values.items():
        _check_kind(f"{kind} {name}", value, parameters[name].default)
    return SYSTEMS[kind](**values)


def _check_kind(name: str, value: Any, default: Any) -> None:
    # Strings and booleans need the type of the default; other parameters are numbers
    wanted = type(default) if isinstance(default, bool | str) else float
    numbers = value if isinstance(value, list | tuple) else [value]
    good = (
        isinstance(value, wanted)
        if wanted is not float
        else all(
            isinstance(n, int | float) and not isinstance(n, bool) and math.isfinite(n)
            for n in numbers
        )
    )
    if not good:
        word = {bool: "true or false", str: "a word", float: "a number"}[wanted]
        raise InputError(f"{name} = {value!r}; {word} expected")


def parse_parameters(text: str) -> dict[str, Any]:
    """Parse the parameters in a text such as `slat_width=0.08,tilt_deg=45`.

    Values for red, green and blue are separated by slashes.

    >>> parse_parameters("openness=0.05,reflectance=0.6/0.5/0.4,shape=round")
    {'openness': 0.05, 'reflectance': [0.6, 0.5, 0.4], 'shape': 'round'}
    """
    values: dict[str, Any] = {}
    for part in filter(None, (word.strip() for word in text.split(","))):
        name, sign, value = (piece.strip() for piece in part.partition("="))
        if not (name and sign and value) or name in values:
            raise InputError(
                f"{part!r}; name=value pairs with different names expected, such as"
                " slat_width=0.08,tilt_deg=45"
            )
        numbers = [_value(piece) for piece in value.split("/")]
        values[name] = numbers if len(numbers) > 1 else numbers[0]
    return values


def _value(word: str) -> Any:
    if word in ("true", "false"):
        return word == "true"
    for kind in (int, float):
        try:
            return kind(word)
        except ValueError:
            continue
    return word


def read_system(path: str | Path) -> System:
    r"""Create the system in a TOML file with `kind` and the parameters of this kind.

    >>> import tempfile
    >>> text = 'kind = "venetian"\nslat_width = 0.08\nspacing = 0.072\n'
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "blind.toml")
    ...     _ = file.write_text(text)
    ...     system = read_system(file)
    >>> system.area.thickness
    0.08
    """
    values = toml_tables(read_text(path), file=path)
    kind = values.pop("kind", None)
    if not isinstance(kind, str):
        raise InputError(
            'no kind; a line such as kind = "venetian" expected', file=path
        )
    try:
        return make_system(kind, values)
    except InputError as error:
        raise InputError(error.message, file=path) from error
