"""Thermal properties of a glazing system by the engine of LBNL WINDOW.

Optical properties are computed by this package, thermal properties by pywincalc (extra
`thermal`), the Python binding of the WINDOW engine (ISO 15099). Systems with diffusers
and BSDFs are passed as grey panes that absorb in the system what the layers absorb of
solar radiation at normal incidence. Panes alone are passed as spectra; other systems
with venetian, woven or perforated shades as spectra and geometry. `light_and_heat`
replaces the sequence of genBSDF and WINDOW.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from types import ModuleType
from typing import Any, Literal, NamedTuple, final, get_args

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.checks import one_of
from clerestory.errors import InputError
from clerestory.glazing.air_flow import Shade
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.glazing_system import Gap, GlazingSystem, check_gaps
from clerestory.glazing.layer import Diffuser, Glass, Layer
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.glazing.standard import Standard, nfrc
from clerestory.glazing.wincalc import (
    Basis,
    engine_gap,
    engine_layer,
    equivalent_pane,
    hemisphere,
    load_engine,
)
from clerestory.hemisphere.klems import klems

Wavelengths = Literal["full", "condensed"]

# Smallest solar transmittance of the layers before a layer; its share is divided by it.
_DARK = 1e-9


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
    light: StackedLayers | None = None,
) -> ThermalFigures:
    """Return U-value, SHGC and temperatures of a glazing system.

    Parameters
    ----------
    layers : layers from outdoors to indoors
    gaps : gaps between the layers, one fewer than layers
    basis : Klems basis for shades, in systems without diffusers and BSDF files
    wavelengths : "full" for all wavelengths of the layers; "condensed" for twenty
        wavelengths, accurate to 0.005 and several times faster for scattering layers
    width, height : dimensions of the window [m]
    tilt_deg : tilt of the window; 90 is vertical
    light : optical properties of the layers by NFRC's averages, if known; saves time in
        systems with diffusers and BSDF files

    Raises
    ------
    InputError : numbers of gaps and layers do not match, or pywincalc rejects a layer
    ClerestoryError : pywincalc is not installed
    """
    check_gaps(layers, gaps)
    one_of(wavelengths, "wavelengths", choices=get_args(Wavelengths))
    one_of(basis, "Klems basis", choices=get_args(Basis))
    engine = load_engine()
    size = {"width_meters": width, "height_meters": height, "tilt_degrees": tilt_deg}
    matrices = any(isinstance(layer, BsdfLayer | Diffuser) for layer in layers)
    shaded = any(isinstance(layer, Shade) for layer in layers)
    exact = matrices or (not shaded and any(map(_scatters, layers)))
    if not exact:
        light = None
    elif light is None or light.standard != nfrc().name:
        light = stack_layers(layers)
    try:
        if light is not None:
            solids, optics = _equivalent_panes(engine, layers, light), {}
        else:
            solids = [engine_layer(engine, layer, klems("full")) for layer in layers]
            optics = _engine_optics(engine, layers, basis, wavelengths)
        spaces = [engine_gap(engine, gap) for gap in gaps]
        winter, summer = (
            engine.GlazingSystem(
                solids, spaces, environment=environment(), **size, **optics
            )
            for environment in (
                engine.nfrc_u_environments,
                engine.nfrc_shgc_environments,
            )
        )
        figures = _figures(engine, winter, summer)
    except RuntimeError as error:
        raise InputError(f"pywincalc rejects the layers: {error}") from error
    if light is None:
        return figures
    visible = light.direct_hemispherical("transmission_front", channel="visible")
    return replace(figures, visible_transmittance=float(visible[_normal(light)]))


def _scatters(layer: Layer) -> bool:
    return not isinstance(layer, Glass) or layer.material.diffuse is not None


def _engine_optics(
    engine: ModuleType, layers: Sequence[Layer], basis: Basis, wavelengths: Wavelengths
) -> dict[str, Any]:
    # Without scattering layers, the engine uses no hemisphere
    scattering = any(_scatters(layer) for layer in layers)
    ranges = engine.SpectalDataWavelengthRangeMethodType
    return {
        "bsdf_hemisphere": hemisphere(engine, basis) if scattering else None,
        "spectral_data_wavelength_range_method": getattr(ranges, wavelengths.upper()),
    }


def _equivalent_panes(
    engine: ModuleType, layers: Sequence[Layer], light: StackedLayers
) -> list[Any]:
    # The first pane reflects what the system reflects, and no other pane reflects:
    # each pane absorbs a share of the flux that the panes before it leave
    normal = _normal(light)
    reflected = float(
        light.direct_hemispherical("reflection_front", channel="solar")[normal]
    )
    left, panes, standard = 1.0, [], engine.load_standard()
    for layer, absorbed in zip(
        layers, light.absorptance["solar", "front"][:, normal], strict=True
    ):
        passed = max(left - float(absorbed) - reflected, _DARK)
        share = {"transmittance": passed / left, "reflectance": reflected / left}
        panes.append(equivalent_pane(engine, layer, standard=standard, **share))
        left, reflected = passed, 0.0
    return panes


def _normal(light: StackedLayers) -> int:
    return int(np.argmax(light.partition.centres()[:, 2]))


def _figures(engine: ModuleType, winter: Any, summer: Any) -> ThermalFigures:
    # pywincalc applies absorbed solar radiation to temperatures only after `shgc()`
    shgc = summer.shgc()
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
        shgc=shgc,
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
    heat = thermal_figures(
        system.layers, system.gaps, wavelengths=wavelengths, light=light
    )
    return LightAndHeat(light, heat)
