"""Optical and thermal properties of a glazing system in one call.

Shading systems that were generated from geometry are layers like panes, which replaces
the procedure of genBSDF followed by WINDOW.
"""

from typing import NamedTuple

from clerestory.glazing.glazing_system import GlazingSystem
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.glazing.standard import Standard
from clerestory.glazing.thermal import ThermalFigures, Wavelengths, thermal_figures
from clerestory.glazing.wincalc import Basis
from clerestory.hemisphere.klems import klems


class LightAndHeat(NamedTuple):
    """Optical and thermal properties of a glazing system.

    Attributes
    ----------
    light : BSDF, and absorptances of the layers
    heat : U, SHGC and temperatures
    """

    light: StackedLayers
    heat: ThermalFigures


def light_and_heat(
    system: GlazingSystem,
    *,
    basis: Basis = "full",
    standard: Standard | None = None,
    wavelengths: Wavelengths = "condensed",
) -> LightAndHeat:
    """Return the BSDF of a glazing system and its thermal properties.

    Parameters
    ----------
    basis : Klems basis of the BSDF
    standard : spectral averages of the BSDF; None for NFRC's
    wavelengths : of the thermal calculation, see `thermal_figures`
    """
    light = stack_layers(
        system.layers,
        partition=klems(basis),
        standard=standard,
        name=system.name,
        gap_thickness=sum(gap.thickness for gap in system.gaps),
    )
    heat = thermal_figures(system.layers, system.gaps, wavelengths=wavelengths)
    return LightAndHeat(light, heat)
