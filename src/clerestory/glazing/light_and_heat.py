"""Light and heat of a system in one call: genBSDF's file, then WINDOW, in one.

A shading system that was traced from its geometry is a layer among panes and gaps. What
took an XML dressed as a shade, WINDOW, and a table typed over, is one function.
"""

from typing import NamedTuple

from clerestory.glazing.glazing_system import GlazingSystem
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.glazing.standard import Standard
from clerestory.glazing.thermal import ThermalFigures, Wavelengths, thermal_figures
from clerestory.glazing.wincalc import Basis
from clerestory.hemisphere.klems import klems


class LightAndHeat(NamedTuple):
    """What a glazing system does.

    Attributes
    ----------
    light : its BSDF, and what each layer keeps
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
    """Return the BSDF of a system and its thermal figures.

    Parameters
    ----------
    basis : Klems basis of the BSDF
    standard : spectral averages of the BSDF; None for NFRC's
    wavelengths : of the thermal engine, see `thermal_figures`

    Raises
    ------
    InputError : layers that cannot be stacked
    ClerestoryError : pywincalc is not installed
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
