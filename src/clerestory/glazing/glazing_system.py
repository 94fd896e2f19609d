"""Glazing systems: layers and the gaps between them, from outdoors to indoors."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import final

from clerestory.brief_repr import brief
from clerestory.checks import not_negative, one_of, positive, require
from clerestory.glazing.layer import Layer

GASES = ("air", "argon", "krypton", "xenon")

# Standard atmospheric pressure [Pa].
ATMOSPHERE = 101_325.0


@final
@dataclass(frozen=True)
class Gap:
    """The space between two layers.

    `thickness` is the distance between the layers [m], `gases` the volume fraction of
    each gas, `pressure` the gas pressure [Pa].
    """

    thickness: float
    gases: Mapping[str, float] = field(default_factory=lambda: {"air": 1.0})
    pressure: float = ATMOSPHERE

    __repr__ = brief

    def __post_init__(self) -> None:
        positive(self.thickness, "thickness of the gap", unit="m")
        positive(self.pressure, "pressure in the gap", unit="Pa")
        for gas, fraction in self.gases.items():
            one_of(gas, "the gas", choices=GASES)
            not_negative(fraction, f"fraction of {gas}")
        total = sum(self.gases.values())
        require(abs(total - 1) <= 1e-6, f"gas fractions sum to {total:g}; 1 expected")


# Default thickness of gaps [m]
_DEFAULT_GAP = 0.0127


@final
@dataclass(frozen=True, eq=False)
class GlazingSystem:
    """At least one layer, from outdoors to indoors, and the gaps between them."""

    name: str
    layers: tuple[Layer, ...]
    gaps: tuple[Gap, ...] = ()

    __repr__ = brief

    def __post_init__(self) -> None:
        require(self.layers, "glazing system without layers; at least one expected")
        check_gaps(self.layers, self.gaps)


def check_gaps(layers: Sequence[Layer], gaps: Sequence[Gap]) -> None:
    """Require one gap fewer than layers."""
    between, count = len(layers) - 1, f"{len(gaps)} gaps between {len(layers)} layers"
    require(len(gaps) == between, f"{count}; {between} expected")


def system_with_equal_gaps(
    layers: list[Layer], *, gap: Gap | None = None, name: str = ""
) -> GlazingSystem:
    """Return a system with equal gaps, 12.7 mm of air by default."""
    between = gap or Gap(_DEFAULT_GAP)
    title = name or " | ".join(layer.name for layer in layers)
    return GlazingSystem(title, tuple(layers), (between,) * (len(layers) - 1))
