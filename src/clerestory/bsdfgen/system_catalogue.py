"""Catalogue of parametric shading systems, created from command lines or TOML files."""

import inspect
import math
from collections.abc import Callable, Mapping
from contextlib import suppress
from pathlib import Path
from types import MappingProxyType
from typing import Any

from clerestory.bsdfgen.film_geometry import mirrored_channels, prismatic
from clerestory.bsdfgen.panes_and_fabrics import clear_pane, diffuse_pane, fabric
from clerestory.bsdfgen.screen_geometry import perforated, woven
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.checks import one_of, require
from clerestory.documents import toml_tables
from clerestory.errors import located
from clerestory.files import read_text

_MAKERS: tuple[Callable[..., System], ...] = (
    *(venetian, microlouvre, prismatic, mirrored_channels, perforated, woven, fabric),
    *(diffuse_pane, clear_pane),
)
SYSTEMS = MappingProxyType({make.__name__: make for make in _MAKERS})


def make_system(kind: str, values: Mapping[str, Any]) -> System:
    """Create a parametric system from its kind and its parameters."""
    one_of(kind, "kind of system", choices=SYSTEMS)
    parameters = inspect.signature(SYSTEMS[kind]).parameters
    for name, parameter in parameters.items():
        given = name in values or parameter.default is not parameter.empty
        require(given, f"{kind} lacks the parameter {name!r}")
    for name, value in values.items():
        one_of(name, f"parameter of {kind}", choices=parameters)
        _check_kind(f"{kind} {name}", value, parameters[name].default)
    return SYSTEMS[kind](**values)


def _check_kind(name: str, value: Any, default: Any) -> None:
    # Strings and booleans need the type of the default; other parameters are numbers
    if isinstance(default, bool | str):
        valid = isinstance(value, type(default))
        expected = "text" if isinstance(default, str) else "true or false"
    else:
        numbers = value if isinstance(value, list | tuple) else [value]
        valid = all(type(n) in (int, float) and math.isfinite(n) for n in numbers)
        expected = "a number"
    require(valid, f"{name} is {value!r}; {expected} expected")


def parse_parameters(text: str) -> dict[str, Any]:
    """Parse the parameters in a text such as `slat_width=0.08,tilt_deg=45`.

    Values for red, green and blue are separated by slashes.

    >>> parse_parameters("openness=0.05,reflectance=0.6/0.5/0.4,shape=round")
    {'openness': 0.05, 'reflectance': [0.6, 0.5, 0.4], 'shape': 'round'}
    """
    values: dict[str, Any] = {}
    for part in filter(None, (word.strip() for word in text.split(","))):
        name, sign, value = (piece.strip() for piece in part.partition("="))
        require(
            name and sign and value and name not in values,
            f"{part!r}; name=value pairs with different names expected, such as"
            " slat_width=0.08,tilt_deg=45",
        )
        numbers = [_value(piece) for piece in value.split("/")]
        values[name] = numbers if len(numbers) > 1 else numbers[0]
    return values


def _value(word: str) -> Any:
    if word in ("true", "false"):
        return word == "true"
    for kind in (int, float):
        with suppress(ValueError):
            return kind(word)
    return word


def read_system(path: str | Path) -> System:
    r"""Create the system that a TOML file describes by `kind` and parameters."""
    values = toml_tables(read_text(path), file=path)
    kind = values.pop("kind", None)
    known = isinstance(kind, str)
    require(known, 'no kind; a line such as kind = "venetian" expected', file=path)
    with located(file=path):
        return make_system(kind, values)
