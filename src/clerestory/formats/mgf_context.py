"""Contexts of MGF: current and named vertices, colours and materials.

A named context can become current again, or serve as template of another context.

Reference: G. Ward, "The Materials and Geometry Format", version 2, LBNL, 1996.
"""

from dataclasses import dataclass, field
from typing import Generic, NamedTuple, TypeVar

from clerestory.checks import require
from clerestory.formats.mgf_colour import GREY, Chromaticity

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
        """Return the `Share` of a keyword; zero if it is not set."""
        return dict(self.shares).get(keyword, Share())


@dataclass
class Contexts(Generic[Value]):
    """All contexts of one type: the current one and the named ones."""

    default: Value
    name: str | None = None
    named: dict[str, Value] = field(default_factory=dict)
    unnamed: Value = field(init=False)

    def __post_init__(self) -> None:
        self.unnamed = self.default

    @property
    def current(self) -> Value:
        """The current context."""
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
        """Select a context by `name`, `name =`, `name = template` or no words."""
        valid = len(words) <= 3 and words[1:2] in ([], ["="])
        shown = " ".join(words[:4])
        require(valid, f'context "{shown}"; a name, = and a template expected')
        if not words:
            self.name, self.unnamed = None, self.default
            return
        if len(words) == 1:
            value = self[words[0]]
        else:
            value = self[words[2]] if len(words) == 3 else self.default
        self.named[words[0]] = value
        self.name = words[0]
