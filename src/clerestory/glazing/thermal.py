"""Thermal properties of a glazing system by the engine of LBNL WINDOW.

Optical properties are computed by this package, thermal properties by pywincalc (extra
`thermal`), the Python binding of the WINDOW engine (ISO 15099). Panes are passed as
spectra, venetian, woven and perforated shades as geometry, BSDFs as two-band matrices.
`light_and_heat` replaces the sequence of genBSDF and WINDOW.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Literal, NamedTuple, final, get_args

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import one_of
from clerestory.errors import InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.glazing_system import Gap, GlazingSystem, check_gaps
from clerestory.glazing.layer import Diffuser, Glass, Layer
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.glazing.standard import Standard
from clerestory.glazing.wincalc import (
    Basis,
    engine_gap,
    engine_layer,
    hemisphere,
    load_engine,
)
from clerestory.hemisphere.klems import klems

Wavelengths = Literal["full", "condensed"]


@final
@dataclass(frozen=True, eq=False)
class ThermalFigures:
    """Thermal properties of a glazing system.

    Attributes
    ----------
    u : thermal transmittance, NFRC winter conditions [W/(m² K)]
    shgc : solar heat gain coefficient, NFRC summer conditions, normal incidence
    solar_transmittance, visible_transmittance : transmittances at normal incidence
    temperatures_winter, temperatures_summer : temperatures of the outdoor and indoor
        face of each layer, under the conditions of U and of SHGC [K]
    relative_heat_gain : relative heat gain (NFRC) [W/m²]
    """

    u: float
    shgc: float
    solar_transmittance: float
    visible_transmittance: float
    temperatures_winter: Float[np.ndarray, "layer 2"]
    temperatures_summer: Float[np.ndarray, "layer 2"]
    relative_heat_gain: float

    __repr__ = brief


def thermal_figures(
    layers: Sequence[Layer],
    gaps: Sequence[Gap] = (),
    *,
    basis: Basis = "quarter",
    wavelengths: Wavelengths = "full",
    width: float = 1.0,
    height: float = 1.0,
    tilt_deg: float = 90.0,
) -> ThermalFigures:
    """Return U-value, SHGC and temperatures of a glazing system.

    Parameters
    ----------
    layers : layers from outdoors to indoors
    gaps : gaps between the layers, one fewer than layers
    basis : Klems basis for shades; BSDF files always use the full basis, the only basis
        that pywincalc supports for them
    wavelengths : "full" for all wavelengths of the layers; "condensed" for twenty
        wavelengths, accurate to 0.005 and several times faster for scattering layers
    width, height : dimensions of the window [m]
    tilt_deg : tilt of the window; 90 is vertical

    Raises
    ------
    InputError : numbers of gaps and layers do not match, or pywincalc rejects a layer
    ClerestoryError : pywincalc is not installed
    """
    check_gaps(layers, gaps)
    one_of(wavelengths, "wavelengths", choices=get_args(Wavelengths))
    partition = klems(basis)
    engine = load_engine()
    scattering = any(
        not isinstance(layer, Glass) or layer.material.diffuse for layer in layers
    )
    full = any(isinstance(layer, (BsdfLayer, Diffuser)) for layer in layers)
    partition = klems("full") if full else partition
    basis_object = hemisphere(engine, "full" if full else basis) if scattering else None
    ranges = engine.SpectalDataWavelengthRangeMethodType
    spectrum = ranges.FULL if wavelengths == "full" else ranges.CONDENSED
    try:
        winter, summer = (
            engine.GlazingSystem(
                [engine_layer(engine, layer, partition) for layer in layers],
                [engine_gap(engine, gap) for gap in gaps],
                width_meters=width,
                height_meters=height,
                tilt_degrees=tilt_deg,
                environment=environment(),
                bsdf_hemisphere=basis_object,
                spectral_data_wavelength_range_method=spectrum,
            )
            for environment in (
                engine.nfrc_u_environments,
                engine.nfrc_shgc_environments,
            )
        )
        return _figures(engine, winter, summer)
    except RuntimeError as error:
        raise InputError(f"pywincalc rejects the layers: {error}") from error


def _figures(engine: ModuleType, winter: Any, summer: Any) -> ThermalFigures:
    solar, visible = (
        summer.optical_method_results(method).system_results.front.transmittance
        for method in ("SOLAR", "PHOTOPIC")
    )
    cold, hot = (
        np.array(system.layer_temperatures(kind)).reshape(-1, 2)
        for system, kind in (
            (winter, engine.TarcogSystemType.U),
            (summer, engine.TarcogSystemType.SHGC),
        )
    )
    return ThermalFigures(
        u=winter.u(),
        shgc=summer.shgc(),
        solar_transmittance=solar.direct_hemispherical,
        visible_transmittance=visible.direct_hemispherical,
        temperatures_winter=cold,
        temperatures_summer=hot,
        relative_heat_gain=summer.relative_heat_gain(),
    )


class LightAndHeat(NamedTuple):
    """Optical and thermal properties of a glazing system."""

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
    standard : standard of the spectral averages; default: NFRC
    wavelengths : wavelengths of the thermal calculation, see `thermal_figures`
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
