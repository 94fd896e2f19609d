"""Statements of MGF that define vertices, colours and materials."""

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from clerestory.errors import InputError
from clerestory.formats import mgf_colour
from clerestory.formats.mgf_context import Contexts, MgfMaterial, MgfVertex, Share
from clerestory.scene.transform import LARGEST, number

_SHARES = ("rd", "td", "rs", "ts")
_HIGHLIGHTS = ("rs", "ts")


@dataclass
class Definitions:
    """Current and named vertices, colours and materials."""

    vertices: Contexts[MgfVertex] = field(default_factory=lambda: Contexts(MgfVertex()))
    colours: Contexts[mgf_colour.Chromaticity] = field(
        default_factory=lambda: Contexts(mgf_colour.GREY)
    )
    materials: Contexts[MgfMaterial] = field(
        default_factory=lambda: Contexts(MgfMaterial())
    )

    def context(self, keyword: str, words: list[str]) -> None:
        """Select the current vertex, colour or material."""
        match keyword:
            case "v":
                self.vertices.choose(words)
            case "c":
                self.colours.choose(words)
            case _:
                self.materials.choose(words)

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
                if len(words) < 4 or len(words) % 2:
                    raise InputError(
                        f"{len(words)} words after {keyword}; weights and colours in"
                        " turn, at least two each, expected"
                    )
                weights = numbers(keyword, words[::2], len(words) // 2)
                parts = [self.colours[name] for name in words[1::2]]
                colour = mgf_colour.mixed(weights, parts)
        self.colours.current = colour

    def share(self, keyword: str, words: list[str]) -> None:
        """Set a reflectance, transmittance or emittance of the current material."""
        value, *rough = numbers(keyword, words, 2 if keyword in _HIGHLIGHTS else 1)
        if not 0 <= value <= (1 if keyword in _SHARES else LARGEST):
            raise InputError(f"{keyword} {value:g}; 0 to 1 expected")
        if min(rough, default=0) < 0:
            raise InputError(f"{keyword} with roughness {rough[0]:g}; 0 or more")
        current = self.materials.current
        share = Share(value, self.colours.current, *rough)
        shares = {**dict(current.shares), keyword: share}
        self.materials.current = replace(current, shares=tuple(shares.items()))

    def surface_kind(self, keyword: str, words: list[str]) -> None:
        """Set the number of sides or the refractive index of the current material."""
        if keyword == "ir":
            index, _ = numbers(keyword, words, 2)
            if index <= 0:
                raise InputError(f"ir {index:g}; an index above 0 expected")
            self.materials.current = replace(self.materials.current, index=index)
            return
        if words not in (["1"], ["2"]):
            raise InputError(f"sides {' '.join(words)[:20]!r}; 1 or 2 expected")
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
    """Return the numbers after a keyword, after checking their count."""
    values = [v for v in map(number, words) if v is not None and abs(v) <= LARGEST]
    if not len(values) == len(words) == count:
        raise InputError(
            f'{keyword} is followed by "{" ".join(words)[:60]}"; {count} number(s)'
            " expected"
        )
    return values
