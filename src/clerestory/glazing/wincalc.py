"""Layers and gaps as objects of pywincalc, the Python binding of the WINDOW engine."""

import importlib
from types import ModuleType
from typing import Any, Literal

import numpy as np

from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.errors import ClerestoryError, InputError
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.glazing_system import Gap
from clerestory.glazing.layer import Diffuser, Glass, Layer
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane
from clerestory.glazing.screen import PerforatedScreen, WovenShade
from clerestory.glazing.venetian import VenetianBlind
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
    """Return a Klems basis of the engine."""
    kinds = engine.BSDFBasisType
    kind = {"full": kinds.FULL, "half": kinds.HALF, "quarter": kinds.QUARTER}[basis]
    return engine.BSDFHemisphere.create(kind)


def engine_gap(engine: ModuleType, gap: Gap) -> Any:
    """Return a gap for the engine."""
    kinds = engine.PredefinedGasType
    known = {
        "air": kinds.AIR,
        "argon": kinds.ARGON,
        "krypton": kinds.KRYPTON,
        "xenon": kinds.XENON,
    }
    gas = engine.create_gas([[share, known[name]] for name, share in gap.gases.items()])
    return engine.Layers.gap(gas=gas, thickness=gap.thickness, pressure=gap.pressure)


def engine_layer(engine: ModuleType, layer: Layer, partition: RingPartition) -> Any:
    """Return a layer for the engine.

    `partition`: full Klems basis, for layers that are passed as matrices.
    """
    if isinstance(layer, Glass):
        return _sheet(engine, layer.material)
    if isinstance(layer, (VenetianBlind, WovenShade, PerforatedScreen)):
        return _shade(engine, layer)
    if isinstance(layer, BsdfLayer):
        return _matrices(engine, layer, partition)
    if isinstance(layer, Diffuser):
        return _even(engine, layer, partition)
    raise InputError(f"pywincalc has no model for the layer {layer.name!r}")


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
    # Front and back transmittance, front and back reflectance
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
        hemisphere(engine, "full"),
        thickness,
        layer.infrared_transmittance,
        layer.infrared_transmittance,
        *emissivities,
        layer.permeability,
    )
    thermal = engine.ProductDataThermal(layer.conductivity, thickness)
    return engine.ProductDataOpticalAndThermal(optical, thermal)


def _even(engine: ModuleType, layer: Diffuser, partition: RingPartition) -> Any:
    # A Lambertian sheet is passed as a two-band matrix
    pane = layer.material
    bands = [
        layer.matrices(np.array([wavelength]), partition).map(lambda f: f[0])
        for wavelength in (1000.0, 550.0)
    ]
    optical = engine.ProductDataOpticalDualBandBSDF(
        *_lists(bands[0]),
        *_lists(bands[1]),
        hemisphere(engine, "full"),
        pane.thickness,
        pane.infrared_transmittance,
        pane.infrared_transmittance,
        pane.emissivity_front,
        pane.emissivity_back,
    )
    return engine.ProductDataOpticalAndThermal(optical, _thermal(engine, pane))


def _lists(optics: Optics) -> list[list[list[float]]]:
    return [optics.of(name).tolist() for name in FUNCTIONS]
