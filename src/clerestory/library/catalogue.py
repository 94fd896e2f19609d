"""Catalogue of the built-in BSDFs: the layers of each by name.

A recipe is a few layers from outdoors to indoors. Panes have published properties;
slats, fabrics and diffusers are grey Lambertian materials of round reflectances, which
stand for a kind of product and not for one of a manufacturer.
"""

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import Literal

from clerestory.glazing.layer import Diffuser, Layer
from clerestory.glazing.pane import grey_pane
from clerestory.glazing.screen import PerforatedScreen
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.venetian import VenetianBlind
from clerestory.library.library_panes import library_pane

Family = Literal["glazing", "blind", "screen", "louvre", "film"]

# Tilt angles that are listed [°]; all whole angles between −90° and 90° are accepted
TILTS = (-45, 0, 15, 30, 45, 60, 75)

# Reflectances of slats, and reflectance and transmittance of the threads of fabrics
_SLATS = {"white": 0.75, "silver": 0.60, "grey": 0.40, "black": 0.05}
_THREADS = {"white": (0.75, 0.15), "grey": (0.35, 0.04), "charcoal": (0.06, 0.0)}

# Distance of the holes of fabrics and sheets [m], relative thickness of fabrics
_PITCH, _DEPTH = 1e-3, 0.1


@dataclass(frozen=True)
class Recipe:
    """Recipe of a built-in BSDF.

    Attributes
    ----------
    family : kind of product
    words : the layers in words, from outdoors to indoors
    layers : function from the tilt angle of the slats [rad] to the layers
    tilts : whether there are slats to tilt
    """

    family: Family
    words: str
    layers: Callable[[float], tuple[Layer, ...]]
    tilts: bool = False


def _glazing(*panes: str, film: bool = False) -> Recipe:
    # A minus turns the pane: its coating faces outdoors
    def layers(_tilt: float) -> tuple[Layer, ...]:
        found = [(library_pane(name.removeprefix("-")), name) for name in panes]
        return tuple(
            pane.flipped() if name.startswith("-") else pane for pane, name in found
        )

    words = " | ".join(
        f"{name[1:]} reversed" if name.startswith("-") else name for name in panes
    )
    return Recipe("film" if film else "glazing", words, layers)


def _slats(
    family: Family,
    width: float,
    spacing: float,
    colour: str,
    *,
    vertical: bool = False,
    tilts: bool = True,
) -> Recipe:
    reflectance = _SLATS[colour]
    material = grey_pane(0.0, reflectance, name=f"{colour} slats")

    def layers(tilt: float) -> tuple[Layer, ...]:
        slats = SlatGeometry(width, spacing, tilt)
        return (VenetianBlind(material, slats, vertical=vertical),)

    kind = "vertical" if vertical else "horizontal"
    words = (
        f"flat {kind} slats, {1000 * width:g} mm wide every {1000 * spacing:.3g} mm,"
        f" reflectance {reflectance:g}"
    )
    return Recipe(family, words, layers, tilts)


def _fabric(openness: float, colour: str) -> Recipe:
    reflectance, transmittance = _THREADS[colour]
    words = (
        f"fabric with {openness:.0%} openness, threads of reflectance {reflectance:g}"
        f" and transmittance {transmittance:g}"
    )
    sheet = partial(_perforated, openness, reflectance, transmittance, _DEPTH * _PITCH)
    return Recipe("screen", words, lambda _tilt: (sheet(),))


def _metal(openness: float) -> Recipe:
    words = f"perforated sheet, {openness:.0%} open, holes as deep as half their pitch"
    sheet = partial(_perforated, openness, 0.5, 0.0, 0.5 * _PITCH)
    return Recipe("screen", words, lambda _tilt: (sheet(),))


def _perforated(
    openness: float, reflectance: float, transmittance: float, thickness: float
) -> PerforatedScreen:
    # Square holes; the material transmits and reflects diffusely
    hole = math.sqrt(openness) * _PITCH
    material = grey_pane(transmittance, reflectance, name=f"{openness:.0%} open sheet")
    return PerforatedScreen(
        replace(material, thickness=thickness),
        "rectangular",
        (_PITCH, _PITCH),
        (hole, hole),
    )


def _diffuser(transmittance: float, reflectance: float) -> Recipe:
    words = f"diffuser of transmittance {transmittance:g}, reflectance {reflectance:g}"
    material = grey_pane(transmittance, reflectance, name="diffuser")
    return Recipe("film", words, lambda _tilt: (Diffuser(material),))


_SINGLE: tuple[str, ...] = (
    "clear-3",
    "clear-6",
    "clear-12",
    "low-iron-3",
    "bronze-6",
    "grey-6",
)
_SINGLE += ("grey-12", "green-6", "pyrolytic-6")
_CUTOFF = math.tan(math.radians(40))

RECIPES: dict[str, Recipe] = {
    **{f"single-{name}": _glazing(name) for name in _SINGLE},
    "double-clear-3": _glazing("clear-3", "clear-3"),
    "double-clear-6": _glazing("clear-6", "clear-6"),
    "double-low-iron-3": _glazing("low-iron-3", "low-iron-3"),
    "double-bronze-6": _glazing("bronze-6", "clear-6"),
    "double-grey-6": _glazing("grey-6", "clear-6"),
    "double-green-6": _glazing("green-6", "clear-6"),
    "double-pyrolytic-6": _glazing("clear-6", "-pyrolytic-6"),
    "double-lowe-3": _glazing("lowe-3", "clear-3"),
    "double-lowe-6": _glazing("lowe-6", "clear-6"),
    "double-lowe-tint-6": _glazing("lowe-tint-6", "clear-6"),
    "double-grey-lowe-6": _glazing("grey-6", "-lowe-6"),
    "double-selective-3": _glazing("selective-3", "clear-3"),
    "double-selective-6": _glazing("selective-6", "clear-6"),
    "double-selective-tint-6": _glazing("selective-tint-6", "clear-6"),
    "triple-clear-3": _glazing("clear-3", "clear-3", "clear-3"),
    "triple-clear-6": _glazing("clear-6", "clear-6", "clear-6"),
    "triple-lowe-3": _glazing("lowe-3", "clear-3", "-lowe-3"),
    "triple-lowe-6": _glazing("lowe-6", "clear-6", "-lowe-6"),
    "triple-selective-6": _glazing("selective-6", "clear-6", "-lowe-6"),
    "triple-green-lowe-6": _glazing("green-6", "clear-6", "-lowe-6"),
    "triple-bronze-lowe-6": _glazing("bronze-6", "clear-6", "-lowe-6"),
    **{
        f"venetian-{width}-{colour}": _slats(
            "blind", width / 1000, spacing / 1000, colour
        )
        for width, spacing in ((25, 21.5), (50, 44), (80, 72))
        for colour in ("white", "silver", "grey")
    },
    "vertical-89-white": _slats("blind", 0.089, 0.080, "white", vertical=True),
    **{
        f"screen-{share}-{colour}": _fabric(share / 100, colour)
        for share in (1, 3, 5, 10)
        for colour in _THREADS
    },
    "perforated-20": _metal(0.20),
    "perforated-40": _metal(0.40),
    "louvre-200-grey": _slats("louvre", 0.200, 0.180, "grey"),
    "louvre-400-grey": _slats("louvre", 0.400, 0.360, "grey"),
    "microlouvre-40": _slats(
        "louvre", 1.25e-3, 1.25e-3 * _CUTOFF, "black", tilts=False
    ),
    **{
        f"polyester-{share}": _glazing(f"polyester-{share}", film=True)
        for share in (88, 77, 66, 55)
    },
    "diffuser-30": _diffuser(0.30, 0.55),
    "diffuser-50": _diffuser(0.50, 0.40),
    "diffuser-80": _diffuser(0.80, 0.12),
}
