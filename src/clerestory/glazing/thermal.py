"""Thermal properties of a glazing system by LBNL's WINDOW engine.

Optical properties are computed by this package, thermal ones by pywincalc (extra
`thermal`), LBNL's binding of the engine of WINDOW (ISO 15099). Panes are passed with
their spectra, venetian, woven and perforated shades with their geometry, BSDFs as
two-band matrices. `light_and_heat` replaces the procedure of genBSDF followed by
WINDOW.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Literal, NamedTuple, final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Points2
from clerestory.errors import InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.glazing_system import Gap, GlazingSystem
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
    solar_transmittance, visible_transmittance : at normal incidence
    temperatures_winter, temperatures_summer : of each layer's two faces, from the sky
        to the room, without sun and with that of SHGC [K]
    relative_heat_gain : [W/m²]
    """

    u: float
    shgc: float
    solar_transmittance: float
    visible_transmittance: float
    temperatures_winter: Float[np.ndarray, "layer 2"]
    temperatures_summer: Float[np.ndarray, "layer 2"]
    relative_heat_gain: float


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
    """Return U, SHGC and temperatures of a glazing system.

    Parameters
    ----------
    layers : from the sky to the room
    gaps : between them, one fewer
    basis : Klems basis for shades; BSDF files always use Klems full, the only one that
        pywincalc supports
    wavelengths : "full" for all wavelengths of the layers; "condensed" for twenty,
        which is accurate to 0.005 and several times faster for scattering layers
    width, height : of the window [m]
    tilt_deg : of the window; 90 is vertical

    Raises
    ------
    InputError : gaps and layers do not match, or the engine refuses them
    ClerestoryError : pywincalc is not installed
    """
    if len(gaps) != len(layers) - 1:
        raise InputError(
            f"{len(gaps)} gaps between {len(layers)} layers; {len(layers) - 1} expected"
        )
    engine = load_engine()
    try:
        return _calculate(
            engine, layers, gaps, basis, wavelengths, (width, height), tilt_deg
        )
    except RuntimeError as error:
        raise InputError(f"pywincalc refuses the layers: {error}") from error


def _calculate(
    engine: ModuleType,
    layers: Sequence[Layer],
    gaps: Sequence[Gap],
    basis: Basis,
    wavelengths: Wavelengths,
    size: tuple[float, float],
    tilt_deg: float,
) -> ThermalFigures:
    scattering = any(
        not isinstance(layer, Glass) or layer.material.diffuse for layer in layers
    )
    full = any(isinstance(layer, (BsdfLayer, Diffuser)) for layer in layers)
    partition = klems("full" if full else basis)
    basis_object = hemisphere(engine, "full" if full else basis) if scattering else None
    ranges = engine.SpectalDataWavelengthRangeMethodType
    spectrum = ranges.FULL if wavelengths == "full" else ranges.CONDENSED
    systems = [
        engine.GlazingSystem(
            [engine_layer(engine, layer, partition) for layer in layers],
            [engine_gap(engine, gap) for gap in gaps],
            width_meters=size[0],
            height_meters=size[1],
            tilt_degrees=tilt_deg,
            environment=environment,
            bsdf_hemisphere=basis_object,
            spectral_data_wavelength_range_method=spectrum,
        )
        for environment in (
            engine.nfrc_u_environments(),
            engine.nfrc_shgc_environments(),
        )
    ]
    winter, summer = systems
    solar, visible = (
        summer.optical_method_results(method).system_results.front.transmittance
        for method in ("SOLAR", "PHOTOPIC")
    )
    return ThermalFigures(
        u=winter.u(),
        shgc=summer.shgc(),
        solar_transmittance=solar.direct_hemispherical,
        visible_transmittance=visible.direct_hemispherical,
        temperatures_winter=_pairs(
            winter.layer_temperatures(engine.TarcogSystemType.U)
        ),
        temperatures_summer=_pairs(
            summer.layer_temperatures(engine.TarcogSystemType.SHGC)
        ),
        relative_heat_gain=summer.relative_heat_gain(),
    )


def _pairs(temperatures: list[float]) -> Points2:
    return np.array(temperatures).reshape(-1, 2)


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
