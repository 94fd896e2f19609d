"""Parameters of blinds, woven shades and screens, from TOML files and the IGSDB."""

import math
from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import ConfigDict, Field

from clerestory.checks import require
from clerestory.documents import Table, validated
from clerestory.errors import InputError
from clerestory.glazing.layer import Layer
from clerestory.glazing.pane import Pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.venetian import VenetianBlind

_MILLIMETRE = 1e-3

# Numbers in the IGSDB may be strings
_Length = Annotated[float, Field(gt=0)]
_Pair = tuple[_Length, _Length]


class GlazingTable(Table):
    """A TOML table of a glazing file; lists become tuples, file names become paths."""

    model_config = ConfigDict(strict=False)


class SlatParameters(GlazingTable):
    """Slats of a venetian blind."""

    material: Path
    width_mm: _Length
    spacing_mm: _Length
    tilt_deg: Annotated[float, Field(ge=-90, le=90)] = 0.0
    curvature_radius_mm: float = 0.0
    segments: int | None = None
    vertical: bool = False
    distribution: Literal["directional", "uniform"] = "directional"

    def layer(self, material: Pane) -> Layer:
        """Return the blind."""
        slats = SlatGeometry(
            width=self.width_mm * _MILLIMETRE,
            spacing=self.spacing_mm * _MILLIMETRE,
            tilt=math.radians(self.tilt_deg),
            curvature_radius=self.curvature_radius_mm * _MILLIMETRE,
            segments=self.segments,
        )
        return VenetianBlind(material, slats, self.distribution, self.vertical)


class ThreadParameters(GlazingTable):
    """Threads of a woven shade."""

    material: Path
    thread_diameter_mm: _Length
    thread_spacing_mm: _Length

    def layer(self, material: Pane) -> Layer:
        """Return the fabric."""
        return WovenShade(
            material,
            thread_diameter=self.thread_diameter_mm * _MILLIMETRE,
            thread_spacing=self.thread_spacing_mm * _MILLIMETRE,
        )


class HoleParameters(GlazingTable):
    """Holes of a perforated screen: circles (`radius_mm`) or rectangles (`size_mm`)."""

    material: Path
    shape: Literal["circular", "rectangular"] = "circular"
    spacing_mm: _Pair
    radius_mm: _Length | None = None
    size_mm: _Pair | None = None

    def layer(self, material: Pane) -> Layer:
        """Return the screen."""
        size, key = self.size_mm, "size_mm"
        if self.shape == "circular":
            key, radius = "radius_mm", self.radius_mm
            size = None if radius is None else (radius, radius)
        if size is None:
            raise InputError(f"{self.shape} perforations require the key {key}")
        (x, y), (width, height) = self.spacing_mm, size
        return PerforatedScreen(
            material,
            self.shape,
            (x * _MILLIMETRE, y * _MILLIMETRE),
            (width * _MILLIMETRE, height * _MILLIMETRE),
        )


ShadeParameters = SlatParameters | ThreadParameters | HoleParameters


def igsdb_shade(geometry: Mapping[str, Any], path: str | Path) -> ShadeParameters:
    """Return the parameters of a shade from its geometry in the IGSDB."""
    get = geometry.get
    table: dict[str, object] = {"material": path}
    if "slat_width" in geometry:
        table |= {"width_mm": get("slat_width"), "spacing_mm": get("slat_spacing")}
        table |= {"tilt_deg": get("slat_tilt"), "segments": get("number_segments")}
        table |= {"curvature_radius_mm": get("slat_curvature")}
        return validated(table, SlatParameters, file=path)
    if "thread_diameter" in geometry:
        for key in ("thread_diameter", "thread_spacing"):
            table[f"{key}_mm"] = get(key)
        return validated(table, ThreadParameters, file=path)
    kind, width = str(get("perforation_type")).lower(), get("dimension_x")
    known = kind in ("circular", "square", "rectangular")
    require(known, "a geometry without slats, threads or perforations", file=path)
    table |= {
        "shape": "rectangular",
        "spacing_mm": (get("spacing_x"), get("spacing_y")),
    }
    if kind == "circular":
        table |= {"shape": kind, "radius_mm": width}
    else:
        height = width if kind == "square" else get("dimension_y")
        table |= {"size_mm": (width, height)}
    return validated(table, HoleParameters, file=path)
