"""Glazing systems of layers and gaps, and their description in TOML.

    name = "Double glazing with an inner blind"

    [[layer]]
    file = "clear_3mm.dat"

    [[gap]]
    thickness_mm = 12.7
    gases = { argon = 0.9, air = 0.1 }

    [[layer]]
    file = "low_e.json"
    flipped = true

    [[gap]]
    thickness_mm = 50

    [[layer]]
    venetian = { material = "slat.json", width_mm = 25, spacing_mm = 20, tilt_deg = 45 }

Layers and gaps are listed from outdoors to indoors. File paths are relative to the
TOML file.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, final

from pydantic import Field

from clerestory.brief_repr import brief
from clerestory.checks import not_negative, one_of, positive, require
from clerestory.documents import Positive, read_toml
from clerestory.errors import located
from clerestory.glazing.layer import Diffuser, Layer
from clerestory.glazing.layer_files import read_layer, read_pane
from clerestory.glazing.shade_parameters import (
    GlazingTable,
    HoleParameters,
    SlatParameters,
    ThreadParameters,
)

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


_MILLIMETRE = 1e-3
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


def read_system(path: str | Path) -> GlazingSystem:
    """Return the glazing system that a TOML file describes.

    Raises
    ------
    InputError : the file is not TOML, has wrong keys, or names an unreadable file
    """
    plan = read_toml(path, _Plan)
    folder, layers = Path(path).parent, []
    for number, row in enumerate(plan.layer, 1):
        with located(file=path, subject=f"layer {number}"):
            layers.append(_layer(row, folder))
    with located(file=path):
        gaps = [
            Gap(row.thickness_mm * _MILLIMETRE, row.gases, row.pressure_pa)
            for row in plan.gap
        ] or [Gap(_DEFAULT_GAP)] * (len(layers) - 1)
        return GlazingSystem(plan.name or Path(path).stem, tuple(layers), tuple(gaps))


class _Row(GlazingTable):
    file: Path | None = None
    venetian: SlatParameters | None = None
    woven: ThreadParameters | None = None
    perforated: HoleParameters | None = None
    diffuser: Path | None = None
    flipped: bool = False


class _Space(GlazingTable):
    thickness_mm: Positive
    gases: dict[str, float] = Field(default_factory=lambda: {"air": 1.0})
    pressure_pa: Positive = ATMOSPHERE


class _Plan(GlazingTable):
    name: str = ""
    layer: Annotated[list[_Row], Field(min_length=1)]
    gap: tuple[_Space, ...] = ()


def _layer(row: _Row, folder: Path) -> Layer:
    kinds = row.model_fields_set - {"flipped"}
    require(
        len(kinds) == 1,
        f"{' and '.join(sorted(kinds)) or 'nothing'} defined; one of file, venetian,"
        " woven, perforated or diffuser expected",
    )
    shade = row.venetian or row.woven or row.perforated
    if shade is not None:
        layer = shade.layer(read_pane(folder / shade.material))
    elif row.diffuser is not None:
        layer = Diffuser(read_pane(folder / row.diffuser))
    else:
        layer = read_layer(folder / (row.file or ""))
    return layer.flipped() if row.flipped else layer
