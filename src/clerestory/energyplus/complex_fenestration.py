"""Glazing systems as complex fenestration states of EnergyPlus.

A `Construction:ComplexFenestrationState` refers to solar and visible BSDFs on a Klems
basis, to the directional absorptances of each layer, and to thermal models of layers
and gaps (EnergyPlus, *Input Output Reference*, group "Surface Construction Elements").
"""

from collections.abc import Iterable, Iterator

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.bsdf.scattering_function import Function, Side
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.checks import require
from clerestory.energyplus.input_objects import InputObject, Value, object_name
from clerestory.glazing.air_flow import AirFlow, Shade, air_flow
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.far_infrared import far_infrared
from clerestory.glazing.glazing_system import Gap, GlazingSystem
from clerestory.glazing.layer import Layer, MaterialLayer
from clerestory.glazing.stack import StackedLayers
from clerestory.glazing.standard import Channel
from clerestory.hemisphere.partition import RingPartition

# Layers and gaps that one state may have
_MOST_LAYERS = 5

# Digits after the decimal point of BSDFs [1/sr] and absorptances
_PLACES = 6

# Fit by which EnergyPlus computes the opening of a BSDF layer from its permeable share,
# see `clerestory.glazing.air_flow`
_FIT = (0.078, 1.2)

# Matrices of a state: part of the BSDF and channel, by suffix of the name
_MATRICES: dict[str, tuple[Function, Channel]] = {
    "TfSol": ("transmission_front", "solar"),
    "RbSol": ("reflection_back", "solar"),
    "TfVis": ("transmission_front", "visible"),
    "TbVis": ("transmission_back", "visible"),
}


def complex_fenestration(
    system: GlazingSystem, light: StackedLayers, *, name: str = ""
) -> list[InputObject]:
    """Return the objects of a complex fenestration state, the construction first.

    Parameters
    ----------
    system : layers and gaps from outdoors to indoors, at most five layers
    light : optical properties of the same layers, on any Klems basis
    name : name of the construction; default: the name of the system

    Raises
    ------
    InputError : more than five layers, or other layers in `light`

    Examples
    --------
    >>> from clerestory.glazing.glazing_system import system_with_equal_gaps
    >>> from clerestory.glazing.layer import Glass
    >>> from clerestory.glazing.pane import grey_pane
    >>> from clerestory.glazing.stack import stack_layers
    >>> from clerestory.hemisphere.klems import klems
    >>> pair = system_with_equal_gaps([Glass(grey_pane(0.8, 0.08))] * 2, name="double")
    >>> light = stack_layers(pair.layers, partition=klems("quarter"))
    >>> [one.kind for one in complex_fenestration(pair, light)][:2]
    ['Construction:ComplexFenestrationState', 'WindowThermalModel:Params']
    """
    count = len(system.layers)
    require(
        count <= _MOST_LAYERS,
        f"glazing system of {count} layers; EnergyPlus reads at most {_MOST_LAYERS}",
    )
    require(
        light.layers == tuple(layer.name for layer in system.layers),
        f"optical properties of {light.layers}; those of the system's layers expected",
    )
    title = object_name(name or system.name)
    fields: dict[str, Value] = {
        "basis_type": "LBNLWindow",
        "basis_symmetry_type": "None",
        "window_thermal_model": f"{title}_Thermal",
        "basis_matrix_name": f"{title}_Basis",
        "solar_optical_complex_front_transmittance_matrix_name": f"{title}_TfSol",
        "solar_optical_complex_back_reflectance_matrix_name": f"{title}_RbSol",
        "visible_optical_complex_front_transmittance_matrix_name": f"{title}_TfVis",
        "visible_optical_complex_back_transmittance_matrix_name": f"{title}_TbVis",
    }
    for number in range(1, count + 1):
        fields |= _layer_fields(title, number, last=number == count)
    return [
        InputObject("Construction:ComplexFenestrationState", title, fields),
        _thermal_model(title),
        *_solids(title, system.layers),
        *_gaps(title, system.gaps),
        *_matrices(title, light),
    ]


def _layer_fields(title: str, number: int, *, last: bool) -> dict[str, Value]:
    layer = "outside_layer" if number == 1 else f"layer_{number}"
    fields: dict[str, Value] = {f"{layer}_name": f"{title}_Layer_{number}"}
    for side in ("front", "back"):
        matrix = f"{title}_Layer_{number}_{side[0]}Abs"
        fields[f"{layer}_directional_{side}_absorptance_matrix_name"] = matrix
    if not last:
        gap = "cfs_gap_1" if number == 1 else f"gap_{number}"
        fields[f"gap_{number}_name"] = f"{title}_Gap_{number}"
        for side in ("front", "back"):
            fields[f"{gap}_directional_{side}_absorptance_matrix_name"] = None
    return fields


def _thermal_model(title: str) -> InputObject:
    fields: dict[str, Value] = {
        "standard": "ISO15099",
        "thermal_model": "ISO15099",
        "sdscalar": 1.0,
        "deflection_model": "NoDeflection",
    }
    return InputObject("WindowThermalModel:Params", f"{title}_Thermal", fields)


def _solids(title: str, layers: Iterable[Layer]) -> Iterator[InputObject]:
    for number, layer in enumerate(layers, 1):
        flow, name = _flow(layer), f"{title}_Layer_{number}"
        yield _pane(name, layer) if flow is None else _shade(name, layer, flow)


def _flow(layer: Layer) -> AirFlow | None:
    if isinstance(layer, Shade):
        return air_flow(layer)
    if isinstance(layer, BsdfLayer) and layer.permeability > 0:
        opening = _FIT[0] * layer.permeability ** _FIT[1]
        return AirFlow(layer.permeability, opening, layer.thickness)
    return None


def _conductivity(layer: Layer) -> float:
    if isinstance(layer, BsdfLayer):
        return layer.conductivity
    assert isinstance(layer, MaterialLayer)
    return layer.material.conductivity


def _pane(name: str, layer: Layer) -> InputObject:
    infrared = far_infrared(layer)
    fields: dict[str, Value] = {
        "optical_data_type": "BSDF",
        "window_glass_spectral_data_set_name": None,
        "thickness": layer.thickness,
        "solar_transmittance_at_normal_incidence": None,
        "front_side_solar_reflectance_at_normal_incidence": None,
        "back_side_solar_reflectance_at_normal_incidence": None,
        "visible_transmittance_at_normal_incidence": None,
        "front_side_visible_reflectance_at_normal_incidence": None,
        "back_side_visible_reflectance_at_normal_incidence": None,
        "infrared_transmittance_at_normal_incidence": infrared.transmittance,
        "front_side_infrared_hemispherical_emissivity": infrared.emissivity_front,
        "back_side_infrared_hemispherical_emissivity": infrared.emissivity_back,
        "conductivity": _conductivity(layer),
    }
    return InputObject("WindowMaterial:Glazing", name, fields)


def _shade(name: str, layer: Layer, flow: AirFlow) -> InputObject:
    infrared = far_infrared(layer)
    share = (flow.opening / _FIT[0]) ** (1 / _FIT[1])
    fields: dict[str, Value] = {
        "layer_type": "BSDF",
        "thickness": flow.thickness,
        "conductivity": _conductivity(layer),
        "ir_transmittance": infrared.transmittance,
        "front_emissivity": infrared.emissivity_front,
        "back_emissivity": infrared.emissivity_back,
        "top_opening_multiplier": 0.0,
        "bottom_opening_multiplier": 0.0,
        "left_side_opening_multiplier": 0.0,
        "right_side_opening_multiplier": 0.0,
        "front_opening_multiplier": min(share, 1.0),
    }
    return InputObject("WindowMaterial:ComplexShade", name, fields)


def _gaps(title: str, gaps: Iterable[Gap]) -> Iterator[InputObject]:
    for number, gap in enumerate(gaps, 1):
        name, gas = f"{title}_Gap_{number}", f"{title}_Gas_{number}"
        fields: dict[str, Value] = {
            "thickness": gap.thickness,
            "gas_or_gas_mixture_": gas,
            "pressure": gap.pressure,
        }
        yield InputObject("WindowMaterial:Gap", name, fields)
        yield _gas(gas, gap)


def _gas(name: str, gap: Gap) -> InputObject:
    shares = {gas: share for gas, share in gap.gases.items() if share > 0}
    if len(shares) == 1:
        only: dict[str, Value] = {
            "gas_type": next(iter(shares)).capitalize(),
            "thickness": gap.thickness,
        }
        return InputObject("WindowMaterial:Gas", name, only)
    fields: dict[str, Value] = {
        "thickness": gap.thickness,
        "number_of_gases_in_mixture": len(shares),
    }
    for number, (gas, share) in enumerate(shares.items(), 1):
        fields[f"gas_{number}_type"] = gas.capitalize()
        fields[f"gas_{number}_fraction"] = share
    return InputObject("WindowMaterial:GasMixture", name, fields)


def _matrices(title: str, light: StackedLayers) -> Iterator[InputObject]:
    yield _matrix(f"{title}_Basis", basis_rows(light.partition))
    for suffix, (part, channel) in _MATRICES.items():
        function = light.bsdf.function(part, channel=channel)
        assert isinstance(function, ScatteringMatrix)
        # Rows are exit directions, columns incident ones, as the engine reads them
        yield _matrix(f"{title}_{suffix}", function.values)
    sides: tuple[Side, Side] = ("front", "back")
    for number in range(len(light.layers)):
        for side in sides:
            absorbed = light.absorptance["solar", side][number]
            yield _matrix(f"{title}_Layer_{number + 1}_{side[0]}Abs", absorbed[None])


def basis_rows(partition: RingPartition) -> Float[np.ndarray, "ring 2"]:
    """Return the polar angle of the middle of each ring [°], and its number of patches.

    The innermost ring is one patch around the normal, at 0°.

    >>> from clerestory.hemisphere.klems import klems
    >>> basis_rows(klems("quarter"))[:3].tolist()
    [[0.0, 1.0], [18.0, 8.0], [36.0, 12.0]]
    """
    limits = np.degrees(np.sort(partition.theta))
    middle = (limits[:-1] + limits[1:]) / 2
    middle[0] = 0.0
    return np.stack([middle, partition.count.astype(float)], axis=1)


def _matrix(name: str, rows: Float[np.ndarray, "row column"]) -> InputObject:
    size: dict[str, Value] = {
        "number_of_rows": rows.shape[0],
        "number_of_columns": rows.shape[1],
    }
    numbers: Values = np.round(rows, _PLACES) + 0.0  # no negative zeros
    return InputObject(
        "Matrix:TwoDimension", name, size, tuple(numbers.ravel().tolist())
    )
