"""Layers and gaps as objects of pywincalc, the Python binding of the WINDOW engine."""

import importlib
from types import ModuleType
from typing import Any, Literal

import numpy as np

from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.errors import ClerestoryError, InputError
from clerestory.glazing.air_flow import Shade, air_flow
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.glazing_system import Gap
from clerestory.glazing.layer import Diffuser, Glass, Layer
from clerestory.glazing.pane import Pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition

Basis = Literal["full", "half", "quarter"]


def load_engine() -> ModuleType:
    """Return pywincalc, or raise ClerestoryError if it is not installed."""
    try:
        return importlib.import_module("pywincalc")
    except ImportError as error:
        raise ClerestoryError(
            "thermal properties require pywincalc, which is not installed; pip install"
            " 'clerestory[thermal]' on platforms with a pywincalc wheel"
        ) from error


def hemisphere(engine: ModuleType, basis: Basis) -> Any:
    """Return a Klems basis as a pywincalc object."""
    return engine.BSDFHemisphere.create(getattr(engine.BSDFBasisType, basis.upper()))


def engine_gap(engine: ModuleType, gap: Gap) -> Any:
    """Return a gap as a pywincalc object."""
    gases = [
        [share, getattr(engine.PredefinedGasType, name.upper())]
        for name, share in gap.gases.items()
    ]
    gas = engine.create_gas(gases)
    return engine.Layers.gap(gas=gas, thickness=gap.thickness, pressure=gap.pressure)


def engine_layer(engine: ModuleType, layer: Layer, partition: RingPartition) -> Any:
    """Return a layer as a pywincalc object.

    `partition`: full Klems basis, for layers that are passed as matrices.
    """
    if isinstance(layer, BsdfLayer | Diffuser):
        return _matrices(engine, layer, partition)
    if not isinstance(layer, Glass | VenetianBlind | WovenShade | PerforatedScreen):
        raise InputError(f"pywincalc has no model for the layer {layer.name!r}")
    pane = layer.material
    sheet = (
        _optical(engine, pane),
        engine.ProductDataThermal(pane.conductivity, pane.thickness),
    )
    if isinstance(layer, Glass):
        return engine.ProductDataOpticalAndThermal(*sheet)
    if isinstance(layer, VenetianBlind):
        return engine.create_venetian_blind(_slats(engine, layer), *sheet)
    if isinstance(layer, WovenShade):
        woven = engine.WovenGeometry(
            layer.thread_diameter, layer.thread_spacing, pane.thickness
        )
        return engine.create_woven_shade(woven, *sheet)
    kinds = engine.PerforatedGeometry.Type
    kind = kinds.CIRCULAR if layer.shape == "circular" else kinds.RECTANGULAR
    holes = engine.PerforatedGeometry(*layer.spacing, *layer.size, kind)
    return engine.create_perforated_screen(holes, *sheet)


def equivalent_pane(
    engine: ModuleType,
    layer: Layer,
    *,
    standard: Any,
    transmittance: float,
    reflectance: float,
) -> Any:
    """Return a grey pane with the thermal properties of a layer.

    `transmittance`, `reflectance`: at normal incidence, on both sides. `standard`:
    pywincalc's optical standard, for the emissivities.
    """
    solid = engine_layer(engine, layer, klems("full"))
    heat = engine.calc_thermal_ir(standard, solid)
    share = transmittance, transmittance, reflectance, reflectance
    rows = [
        engine.WavelengthData(micrometres, engine.OpticalMeasurementComponent(*share))
        for micrometres in (0.3, 2.5)
    ]
    thermal, opening = solid.thermal_data, solid.optical_data.permeability_factor
    if isinstance(layer, Shade):
        # pywincalc uses one number as opening and as the share of gas in the layer.
        # Thickness and conductivity give the same conduction through gas and material
        flow = air_flow(layer)
        opening = flow.opening
        gas = opening / flow.permeability if opening else 1.0
        material = (1 - flow.permeability) / (1 - opening)
        thermal = engine.ProductDataThermal(
            thermal.conductivity * gas * material, flow.thickness * gas
        )
    optical = engine.ProductDataOpticalNBand(
        engine.MaterialType.MONOLITHIC,
        thermal.thickness_meters,
        rows,
        coated_side=engine.CoatedSide.NEITHER,
        ir_transmittance_front=heat.transmittance_front_diffuse_diffuse,
        ir_transmittance_back=heat.transmittance_back_diffuse_diffuse,
        emissivity_front=heat.emissivity_front_hemispheric,
        emissivity_back=heat.emissivity_back_hemispheric,
        permeability_factor=opening,
    )
    return engine.ProductDataOpticalAndThermal(optical, thermal)


def _optical(engine: ModuleType, pane: Pane) -> Any:
    kind = engine.MaterialType.COATED if pane.coated else engine.MaterialType.MONOLITHIC
    # Front and back transmittance, front and back reflectance
    parts = [pane.direct] if pane.diffuse is None else [pane.direct, pane.diffuse]
    rows = [
        engine.WavelengthData(
            wavelength * 1e-3,
            *(
                engine.OpticalMeasurementComponent(
                    *(float(share[row]) for share in vars(part).values())
                )
                for part in parts
            ),
        )
        for row, wavelength in enumerate(pane.wavelength_nm)
    ]
    return engine.ProductDataOpticalNBand(
        kind,
        pane.thickness,
        rows,
        coated_side=getattr(engine.CoatedSide, pane.coated_side.upper()),
        ir_transmittance_front=pane.infrared_transmittance,
        ir_transmittance_back=pane.infrared_transmittance,
        emissivity_front=pane.emissivity_front,
        emissivity_back=pane.emissivity_back,
    )


def _slats(engine: ModuleType, blind: VenetianBlind) -> Any:
    methods, slats = engine.DistributionMethodType, blind.slats
    return engine.VenetianGeometry(
        slat_tilt_degrees=float(np.degrees(slats.tilt)),
        slat_width_meters=slats.width,
        slat_spacing_meters=slats.spacing,
        slat_curvature_meters=slats.curvature_radius,
        is_horizontal=not blind.vertical,
        distribution_method=methods.DIRECTIONAL_DIFFUSE
        if blind.distribution == "directional"
        else methods.UNIFORM_DIFFUSE,
        number_slat_segments=slats.segment_count,
    )


def _matrices(
    engine: ModuleType, layer: BsdfLayer | Diffuser, partition: RingPartition
) -> Any:
    # Solar and visible matrices
    if isinstance(layer, BsdfLayer):
        bands = [layer.band("solar", partition), layer.band("visible", partition)]
        infrared, conductivity = layer.infrared_transmittance, layer.conductivity
        permeability = [layer.permeability]
    else:
        wavelengths = (np.array([1000.0]), np.array([550.0]))
        bands = [
            layer.matrices(wavelength, partition).map(lambda f: f[0])
            for wavelength in wavelengths
        ]
        infrared = layer.material.infrared_transmittance
        conductivity, permeability = layer.material.conductivity, []
    optical = engine.ProductDataOpticalDualBandBSDF(
        *(band.of(name).tolist() for band in bands for name in FUNCTIONS),
        hemisphere(engine, "full"),
        layer.thickness,
        infrared,
        infrared,
        *layer.emissivities,
        *permeability,
    )
    thermal = engine.ProductDataThermal(conductivity, layer.thickness)
    return engine.ProductDataOpticalAndThermal(optical, thermal)
