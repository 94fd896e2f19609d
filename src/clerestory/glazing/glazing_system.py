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

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, final

from pydantic import Field

from clerestory.documents import Positive, read_toml
from clerestory.errors import InputError, located
from clerestory.glazing.layer import Diffuser, Layer
from clerestory.glazing.layer_files import read_layer, read_pane
from clerestory.glazing.shade_parameters import (
    GlazingTable,
    HoleParameters,
    SlatParameters,
    ThreadParameters,
)

GASES = ("air", "argon", "krypton", "xenon")

# Standard atmosphere [Pa].
ATMOSPHERE = 101_325.0


@final
@dataclass(frozen=True)
class Gap:
    """The space between two layers.

    Attributes
    ----------
    thickness : distance between the layers [m]
    gases : volume fraction of each gas; the fractions sum to 1
    pressure : gas pressure [Pa]

    Raises
    ------
    InputError : thickness or pressure not above 0, unknown gases, or a wrong sum of
        fractions

    Examples
    --------
    >>> Gap(0.016, {"argon": 0.9, "air": 0.1}).thickness
    0.016
    """

    thickness: float
    gases: Mapping[str, float] = field(default_factory=lambda: {"air": 1.0})
    pressure: float = ATMOSPHERE

    def __post_init__(self) -> None:
        if not (self.thickness > 0 and self.pressure > 0):
            raise InputError(
                f"gap of {self.thickness:g} m at {self.pressure:g} Pa; thickness and"
                " pressure above 0 expected"
            )
        unknown = [name for name in self.gases if name not in GASES]
        if unknown:
            raise InputError(
                f"unknown gas {unknown[0]!r}; one of {', '.join(GASES)} expected"
            )
        total = sum(self.gases.values())
        if min(self.gases.values(), default=0) < 0 or abs(total - 1) > 1e-6:
            raise InputError(f"gas fractions sum to {total:g}; 1 expected")


_MILLIMETRE = 1e-3
_DEFAULT_GAP = 0.0127


@final
@dataclass(frozen=True, eq=False)
class GlazingSystem:
    """Layers and gaps from outdoors to indoors.

    Attributes
    ----------
    name : name in reports
    layers : layers from outdoors to indoors, at least one
    gaps : gaps between the layers, one fewer than layers

    Raises
    ------
    InputError : no layers, or a wrong number of gaps
    """

    name: str
    layers: tuple[Layer, ...]
    gaps: tuple[Gap, ...] = ()

    def __post_init__(self) -> None:
        if not self.layers:
            raise InputError("glazing system without layers; at least one expected")
        if len(self.gaps) != len(self.layers) - 1:
            raise InputError(
                f"{len(self.gaps)} gaps between {len(self.layers)} layers;"
                f" {len(self.layers) - 1} expected"
            )


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
    InputError : not TOML, unknown or missing keys, files that cannot be read
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
    if len(kinds) != 1:
        raise InputError(
            f"{' and '.join(sorted(kinds)) or 'nothing'} defined; one of file,"
            " venetian, woven, perforated or diffuser expected"
        )
    shade = row.venetian or row.woven or row.perforated
    if shade is not None:
        layer = shade.layer(read_pane(folder / shade.material))
    elif row.diffuser is not None:
        layer = Diffuser(read_pane(folder / row.diffuser))
    else:
        layer = read_layer(folder / (row.file or ""))
    return layer.flipped() if row.flipped else layer
