"""Vertices, colours and materials of MGF, and the statements that define them.

A named vertex, colour or material can be selected again, or copied to a new one.

Reference: G. Ward, "The Materials and Geometry Format", version 2, LBNL, 1996.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from clerestory.checks import not_negative, one_of, positive, require, within
from clerestory.errors import InputError
from clerestory.formats import mgf_colour
from clerestory.formats.mgf_colour import GREY, Chromaticity
from clerestory.scene.transform import LARGEST, number

_SHARES = ("rd", "td", "rs", "ts")
_HIGHLIGHTS = ("rs", "ts")

Value = TypeVar("Value")


@dataclass(frozen=True)
class MgfVertex:
    """A point with an optional normal."""

    point: tuple[float, float, float] = (0.0, 0.0, 0.0)
    normal: tuple[float, float, float] | None = None


class Share(NamedTuple):
    """A reflectance, transmittance or emittance, with colour and roughness.

    `value` is a fraction 0…1; for emittance ("ed"), the luminous exitance [lm/m²].
    """

    value: float = 0.0
    colour: Chromaticity = GREY
    roughness: float = 0.0


@dataclass(frozen=True)
class MgfMaterial:
    """A material of MGF.

    `shares` has the reflectances, transmittances and emittance by keyword: "rd", "td",
    "rs", "ts" and "ed".
    """

    one_sided: bool = False
    index: float = 1.0
    shares: tuple[tuple[str, Share], ...] = ()

    def share(self, keyword: str) -> Share:
        """Return the `Share` of a keyword such as "rd"; value 0 if it is not set."""
        return dict(self.shares).get(keyword, Share())


@dataclass
class Contexts(Generic[Value]):
    """The current and the named vertices, colours or materials (MGF contexts)."""

    default: Value
    name: str | None = None
    named: dict[str, Value] = field(default_factory=dict)
    unnamed: Value = field(init=False)

    def __post_init__(self) -> None:
        self.unnamed = self.default

    @property
    def current(self) -> Value:
        """The current vertex, colour or material."""
        return self.unnamed if self.name is None else self.named[self.name]

    @current.setter
    def current(self, value: Value) -> None:
        if self.name is None:
            self.unnamed = value
        else:
            self.named[self.name] = value

    def __getitem__(self, name: str) -> Value:
        require(name in self.named, f'undefined name "{name}"; a defined name expected')
        return self.named[name]

    def choose(self, words: list[str]) -> None:
        """Select `name`, define it (`name = template`), or reset to the default."""
        valid = len(words) <= 3 and words[1:2] in ([], ["="])
        shown = f'"{" ".join(words[:4])}" after v, c or m'
        require(valid, f"{shown}; `name`, `name =` or `name = template` expected")
        if not words:
            self.name, self.unnamed = None, self.default
            return
        if len(words) == 1:
            value = self[words[0]]
        else:
            value = self[words[2]] if len(words) == 3 else self.default
        self.named[words[0]] = value
        self.name = words[0]


@dataclass
class Definitions:
    """Current and named vertices, colours and materials."""

    vertices: Contexts[MgfVertex] = field(default_factory=lambda: Contexts(MgfVertex()))
    colours: Contexts[Chromaticity] = field(default_factory=lambda: Contexts(GREY))
    materials: Contexts[MgfMaterial] = field(
        default_factory=lambda: Contexts(MgfMaterial())
    )

    def context(self, keyword: str, words: list[str]) -> None:
        """Select or define the vertex, colour or material that becomes current."""
        contexts: dict[str, Contexts[Any]]
        contexts = {"v": self.vertices, "c": self.colours, "m": self.materials}
        contexts[keyword].choose(words)

    def vertex(self, keyword: str, words: list[str]) -> None:
        """Set the point or the normal of the current vertex."""
        x, y, z = numbers(keyword, words, 3)
        if keyword == "p":
            self.vertices.current = replace(self.vertices.current, point=(x, y, z))
            return
        length = float(np.hypot(np.hypot(x, y), z))
        normal = (x / length, y / length, z / length) if length > 1e-6 else None
        self.vertices.current = replace(self.vertices.current, normal=normal)

    def colour(self, keyword: str, words: list[str]) -> None:
        """Set the current colour."""
        match keyword:
            case "cxy":
                colour = mgf_colour.chromaticity(*numbers(keyword, words, 2))
            case "cct":
                colour = mgf_colour.from_temperature(*numbers(keyword, words, 1))
            case "cspec":
                values = numbers(keyword, words, max(4, len(words)))
                colour = mgf_colour.from_spectrum(values)
            case _:
                require(
                    len(words) > 3 and len(words) % 2 == 0,
                    f"{len(words)} words after {keyword}; weights and colours in turn,"
                    " at least two each, expected",
                )
                weights = numbers(keyword, words[::2], len(words) // 2)
                parts = [self.colours[name] for name in words[1::2]]
                colour = mgf_colour.mixed(weights, parts)
        self.colours.current = colour

    def share(self, keyword: str, words: list[str]) -> None:
        """Set a reflectance, transmittance or emittance of the current material."""
        value, *rough = numbers(keyword, words, 2 if keyword in _HIGHLIGHTS else 1)
        most = 1 if keyword in _SHARES else LARGEST
        within(value, keyword, least=0, most=most)
        not_negative(rough, f"roughness of {keyword}")
        current = self.materials.current
        share = Share(value, self.colours.current, *rough)
        shares = {**dict(current.shares), keyword: share}
        self.materials.current = replace(current, shares=tuple(shares.items()))

    def surface_kind(self, keyword: str, words: list[str]) -> None:
        """Set the number of sides or the refractive index of the current material."""
        if keyword == "ir":
            index, _ = numbers(keyword, words, 2)
            positive(index, "index of refraction")
            self.materials.current = replace(self.materials.current, index=index)
            return
        one_of(" ".join(words), "number of sides", choices=("1", "2"))
        one = words == ["1"]
        self.materials.current = replace(self.materials.current, one_sided=one)


DEFINING: dict[str, Callable[[Definitions, str, list[str]], None]] = {
    **dict.fromkeys(("v", "c", "m"), Definitions.context),
    **dict.fromkeys(("p", "n"), Definitions.vertex),
    **dict.fromkeys(("cxy", "cct", "cspec", "cmix"), Definitions.colour),
    **dict.fromkeys((*_SHARES, "ed"), Definitions.share),
    **dict.fromkeys(("sides", "ir"), Definitions.surface_kind),
}


def numbers(keyword: str, words: list[str], count: int) -> list[float]:
    """Check the count of the numbers that follow a keyword, and return them."""
    values = [v for v in map(number, words) if v is not None and abs(v) <= LARGEST]
    if not len(values) == len(words) == count:
        given = f'{keyword} is followed by "{" ".join(words)[:60]}"'
        raise InputError(f"{given}; {count} number(s) expected")
    return values
