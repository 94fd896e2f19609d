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

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Annotated, Literal, final

from pydantic import ConfigDict, Field

from clerestory.errors import InputError
from clerestory.glazing.layer import Diffuser, Layer
from clerestory.glazing.layer_files import read_layer, read_pane
from clerestory.glazing.pane import Pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.venetian import VenetianBlind
from clerestory.toml_tables import Table, read_table

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
    plan = read_table(_Plan, path)
    folder = Path(path).parent
    layers = [
        _layer(row, folder, path, number) for number, row in enumerate(plan.layer, 1)
    ]
    try:
        gaps = tuple(
            Gap(row.thickness_mm * _MILLIMETRE, row.gases, row.pressure_pa)
            for row in plan.gap
        )
        if not gaps and len(layers) > 1:
            gaps = (Gap(_DEFAULT_GAP),) * (len(layers) - 1)
        return GlazingSystem(plan.name or Path(path).stem, tuple(layers), gaps)
    except InputError as error:
        raise InputError(error.message, file=path) from error


_Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]


class _Strict(Table):
    model_config = ConfigDict(strict=False)


class _Slats(_Strict):
    material: Path
    width_mm: _Positive
    spacing_mm: _Positive
    tilt_deg: Annotated[float, Field(ge=-90, le=90)] = 0.0
    curvature_radius_mm: Annotated[float, Field(allow_inf_nan=False)] = 0.0
    segments: int = 5
    vertical: bool = False
    distribution: Literal["directional", "uniform"] = "directional"


class _Woven(_Strict):
    material: Path
    thread_diameter_mm: _Positive
    thread_spacing_mm: _Positive


class _Perforated(_Strict):
    material: Path
    shape: Literal["circular", "rectangular"] = "circular"
    spacing_mm: tuple[_Positive, _Positive]
    radius_mm: _Positive | None = None
    size_mm: tuple[_Positive, _Positive] | None = None


class _Row(_Strict):
    file: Path | None = None
    venetian: _Slats | None = None
    woven: _Woven | None = None
    perforated: _Perforated | None = None
    diffuser: Path | None = None
    flipped: bool = False


class _Space(_Strict):
    thickness_mm: _Positive
    gases: dict[str, float] = Field(default={"air": 1.0})
    pressure_pa: _Positive = ATMOSPHERE


class _Plan(_Strict):
    name: str = ""
    layer: Annotated[list[_Row], Field(min_length=1)]
    gap: list[_Space] = Field(default=[])


def _layer(row: _Row, folder: Path, path: str | Path, number: int) -> Layer:
    kinds = [
        k
        for k in ("file", "venetian", "woven", "perforated", "diffuser")
        if getattr(row, k)
    ]
    if len(kinds) != 1:
        raise InputError(
            f"layer {number} is {' and '.join(kinds) or 'undefined'}; one of file,"
            " venetian, woven, perforated or diffuser expected",
            file=path,
        )
    try:
        layer = _made(row, folder)
    except InputError as error:
        if error.file is not None:
            raise
        raise InputError(f"layer {number}: {error.message}", file=path) from error
    return layer.flipped() if row.flipped else layer


def _made(row: _Row, folder: Path) -> Layer:
    if row.file is not None:
        return read_layer(folder / row.file)
    if row.diffuser is not None:
        return Diffuser(read_pane(folder / row.diffuser))
    if row.venetian is not None:
        plan = row.venetian
        slats = SlatGeometry(
            width=plan.width_mm * _MILLIMETRE,
            spacing=plan.spacing_mm * _MILLIMETRE,
            tilt=math.radians(plan.tilt_deg),
            curvature_radius=plan.curvature_radius_mm * _MILLIMETRE,
            segments=plan.segments,
        )
        return VenetianBlind(
            read_pane(folder / plan.material),
            slats,
            distribution=plan.distribution,
            vertical=plan.vertical,
        )
    if row.woven is not None:
        return WovenShade(
            read_pane(folder / row.woven.material),
            thread_diameter=row.woven.thread_diameter_mm * _MILLIMETRE,
            thread_spacing=row.woven.thread_spacing_mm * _MILLIMETRE,
        )
    assert row.perforated is not None  # checked by the caller
    return _screen(row.perforated, read_pane(folder / row.perforated.material))


def _screen(plan: _Perforated, material: Pane) -> PerforatedScreen:
    wanted = plan.radius_mm if plan.shape == "circular" else plan.size_mm
    if wanted is None:
        key = "radius_mm" if plan.shape == "circular" else "size_mm"
        raise InputError(f"{plan.shape} perforations require the key {key}")
    size = (wanted, wanted) if isinstance(wanted, float) else wanted
    return PerforatedScreen(
        material,
        plan.shape,
        (plan.spacing_mm[0] * _MILLIMETRE, plan.spacing_mm[1] * _MILLIMETRE),
        (size[0] * _MILLIMETRE, size[1] * _MILLIMETRE),
    )
