"""Heat through a stack: U, SHGC and temperatures, by LBNL's WINDOW engine.

Light is ours, heat is pywincalc's, LBNL's own binding of the engine in WINDOW
(ISO 15099). It comes with the extra `thermal`. Layers go to it as what they are: panes
with their spectra, venetian, woven and perforated shades with their geometry, BSDFs
as two-band matrices.
"""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Literal, final

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering import FUNCTIONS
from clerestory.errors import ClerestoryError, InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.diffuser import Diffuser
from clerestory.glazing.gap import Gap
from clerestory.glazing.layer import Glass, Layer
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition

Basis = Literal["full", "half", "quarter"]
Wavelengths = Literal["full", "condensed"]


@final
@dataclass(frozen=True, eq=False)
class ThermalFigures:
    """What a stack lets through of heat and sun, from LBNL's engine.

    Attributes
    ----------
    u : thermal transmittance, NFRC winter conditions [W/(m² K)]
    shgc : solar heat gain coefficient, NFRC summer conditions, sun along the normal
    solar_transmittance, visible_transmittance : along the normal, in all
    temperatures_winter, temperatures_summer : of each layer's two faces, from the
        sky to the room, with no sun and with the sun of SHGC [K]
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
    """Return U, SHGC and temperatures of a stack.

    Parameters
    ----------
    layers : from the sky to the room
    gaps : between them, one fewer
    basis : Klems basis that shades are computed on; panes alone need none. BSDF
        files are always taken on the 145 patches, the only ones pywincalc knows.
    wavelengths : "full" takes all that the layers are known at, as pywincalc does
        unless told; "condensed" takes twenty, which is good to 0.005 and several
        times quicker where light is scattered
    width, height : of the window [m]
    tilt_deg : of the window; 90 is upright

    Raises
    ------
    InputError : gaps and layers do not match, or the engine refuses them
    ClerestoryError : pywincalc is not installed
    """
    if len(gaps) != len(layers) - 1:
        raise InputError(
            f"{len(gaps)} gaps between {len(layers)} layers; {len(layers) - 1} expected"
        )
    engine = _engine()
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
        not isinstance(layer, Glass) or layer.pane.diffuse for layer in layers
    )
    full = any(isinstance(layer, (BsdfLayer, Diffuser)) for layer in layers)
    partition = klems("full" if full else basis)
    hemisphere = _hemisphere(engine, "full" if full else basis) if scattering else None
    ranges = engine.SpectalDataWavelengthRangeMethodType
    spectrum = ranges.FULL if wavelengths == "full" else ranges.CONDENSED
    systems = [
        engine.GlazingSystem(
            [_solid(engine, layer, partition) for layer in layers],
            [_gap(engine, gap) for gap in gaps],
            width_meters=size[0],
            height_meters=size[1],
            tilt_degrees=tilt_deg,
            environment=environment,
            bsdf_hemisphere=hemisphere,
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


def _engine() -> ModuleType:
    try:
        return importlib.import_module("pywincalc")
    except ImportError as error:
        raise ClerestoryError(
            "heat needs pywincalc, which is not installed; pip install"
            " 'clerestory[thermal]' where it has a wheel"
        ) from error


def _hemisphere(engine: ModuleType, basis: Basis) -> Any:
    kinds = engine.BSDFBasisType
    kind = {"full": kinds.FULL, "half": kinds.HALF, "quarter": kinds.QUARTER}[basis]
    return engine.BSDFHemisphere.create(kind)


def _gap(engine: ModuleType, gap: Gap) -> Any:
    kinds = engine.PredefinedGasType
    known = {
        "air": kinds.AIR,
        "argon": kinds.ARGON,
        "krypton": kinds.KRYPTON,
        "xenon": kinds.XENON,
    }
    gas = engine.create_gas([[share, known[name]] for name, share in gap.gases.items()])
    return engine.Layers.gap(gas=gas, thickness=gap.thickness, pressure=gap.pressure)


def _solid(engine: ModuleType, layer: Layer, partition: RingPartition) -> Any:
    if isinstance(layer, Glass):
        return _sheet(engine, layer.pane)
    if isinstance(layer, (VenetianBlind, WovenShade, PerforatedScreen)):
        return _shade(engine, layer)
    if isinstance(layer, BsdfLayer):
        return _matrices(engine, layer, partition)
    if isinstance(layer, Diffuser):
        return _even(engine, layer, partition)
    raise InputError(f"pywincalc knows no layers like {layer.name!r}")


def _sheet(engine: ModuleType, pane: Pane) -> Any:
    return engine.ProductDataOpticalAndThermal(
        _optical(engine, pane), _thermal(engine, pane)
    )


def _optical(engine: ModuleType, pane: Pane) -> Any:
    kind = engine.MaterialType.COATED if pane.coated else engine.MaterialType.MONOLITHIC
    sides = engine.CoatedSide
    coated = {"front": sides.FRONT, "back": sides.BACK, "both": sides.BOTH}
    rows = [
        engine.WavelengthData(wavelength * 1e-3, *_components(engine, pane, row))
        for row, wavelength in enumerate(pane.wavelength_nm)
    ]
    return engine.ProductDataOpticalNBand(
        kind,
        pane.thickness,
        rows,
        coated_side=coated.get(pane.coated_side, sides.NEITHER),
        ir_transmittance_front=pane.infrared_transmittance,
        ir_transmittance_back=pane.infrared_transmittance,
        emissivity_front=pane.emissivity_front,
        emissivity_back=pane.emissivity_back,
    )


def _components(engine: ModuleType, pane: Pane, row: int) -> list[Any]:
    # Front transmittance, back transmittance, front reflectance, back reflectance
    parts = [pane.direct] if pane.diffuse is None else [pane.direct, pane.diffuse]
    return [
        engine.OpticalMeasurementComponent(
            *(float(share[row]) for share in vars(part).values())
        )
        for part in parts
    ]


def _thermal(engine: ModuleType, pane: Pane) -> Any:
    return engine.ProductDataThermal(pane.conductivity, pane.thickness)


def _shade(
    engine: ModuleType, layer: VenetianBlind | WovenShade | PerforatedScreen
) -> Any:
    optical, thermal = (
        _optical(engine, layer.material),
        _thermal(engine, layer.material),
    )
    if isinstance(layer, VenetianBlind):
        methods, slats = engine.DistributionMethodType, layer.slats
        geometry = engine.VenetianGeometry(
            slat_tilt_degrees=float(np.degrees(slats.tilt)),
            slat_width_meters=slats.width,
            slat_spacing_meters=slats.spacing,
            slat_curvature_meters=slats.curvature_radius,
            is_horizontal=not layer.vertical,
            distribution_method=methods.DIRECTIONAL_DIFFUSE
            if layer.distribution == "directional"
            else methods.UNIFORM_DIFFUSE,
            number_slat_segments=slats.segments,
        )
        return engine.create_venetian_blind(geometry, optical, thermal)
    if isinstance(layer, WovenShade):
        woven = engine.WovenGeometry(
            layer.thread_diameter, layer.thread_spacing, layer.material.thickness
        )
        return engine.create_woven_shade(woven, optical, thermal)
    kinds = engine.PerforatedGeometry.Type
    holes = engine.PerforatedGeometry(
        *layer.spacing,
        *layer.size,
        kinds.CIRCULAR if layer.shape == "circular" else kinds.RECTANGULAR,
    )
    return engine.create_perforated_screen(holes, optical, thermal)


def _matrices(engine: ModuleType, layer: BsdfLayer, partition: RingPartition) -> Any:
    thickness, emissivities = layer.thickness, layer.emissivities
    optical = engine.ProductDataOpticalDualBandBSDF(
        *_lists(layer.band("solar", partition)),
        *_lists(layer.band("visible", partition)),
        _hemisphere(engine, "full"),
        thickness,
        layer.infrared_transmittance,
        layer.infrared_transmittance,
        *emissivities,
        layer.permeability,
    )
    thermal = engine.ProductDataThermal(layer.conductivity, thickness)
    return engine.ProductDataOpticalAndThermal(optical, thermal)


def _even(engine: ModuleType, layer: Diffuser, partition: RingPartition) -> Any:
    # A two-band matrix stands for cloth without openings
    pane = layer.material
    bands = [
        layer.matrices(np.array([wavelength]), partition).map(lambda f: f[0])
        for wavelength in (1000.0, 550.0)
    ]
    optical = engine.ProductDataOpticalDualBandBSDF(
        *_lists(bands[0]),
        *_lists(bands[1]),
        _hemisphere(engine, "full"),
        pane.thickness,
        pane.infrared_transmittance,
        pane.infrared_transmittance,
        pane.emissivity_front,
        pane.emissivity_back,
    )
    return engine.ProductDataOpticalAndThermal(optical, _thermal(engine, pane))


def _lists(optics: Optics) -> list[list[list[float]]]:
    return [optics.of(name).tolist() for name in FUNCTIONS]


def _pairs(temperatures: list[float]) -> Float[np.ndarray, "layer 2"]:
    return np.array(temperatures).reshape(-1, 2)
