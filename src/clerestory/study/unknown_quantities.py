"""Unknown quantities of a study: their values in the model, and what they act on."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import Scene
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.uncertainty_tables import (
    OF_MEASUREMENTS,
    USUAL,
    USUAL_DIRT,
    UnknownTable,
    Usual,
)
from clerestory.uncertainty.distributions import (
    Distribution,
    choice,
    normal,
    triangular,
    uniform,
)
from clerestory.uncertainty.draws import Unknown

_WINDOW_KINDS = ("transmittance", "dirt", "bsdf")


@dataclass(frozen=True, eq=False)
class UnknownQuantities:
    """Unknown quantities of a study, by what they act on.

    Attributes
    ----------
    unknowns : all quantities, in the order of the study
    materials : name of the material of each quantity that scales a material
    windows : numbers of the window groups of each quantity to which the light through
        windows is proportional
    sky, sun : quantities to which the light of the sky or the sun is proportional
    weather : quantity that chooses the weather; "" if the weather is known
    clock : shift of the measured times; "" if it is known
    gains : grid of each factor of measured values; "" for all grids
    tables : tables of the study file, by name of the quantity
    """

    unknowns: tuple[Unknown, ...]
    materials: dict[str, str]
    windows: dict[str, tuple[int, ...]]
    sky: tuple[str, ...]
    sun: tuple[str, ...]
    weather: str
    clock: str
    gains: dict[str, str]
    tables: dict[str, UnknownTable]

    __repr__ = brief

    @property
    def reference(self) -> dict[str, float]:
        """Value of each quantity in the model."""
        return {own.name: own.reference for own in self.unknowns}

    def of_materials(self, values: dict[str, float]) -> dict[str, float]:
        """Return the values of materials by name of the material."""
        return {self.materials[n]: v for n, v in values.items() if n in self.materials}


def unknown_quantities(
    study: Study,
    inputs: Inputs,
    tables: Sequence[UnknownTable],
    *,
    measured: bool = False,
) -> UnknownQuantities:
    """Return the unknown quantities of a study.

    Quantities of measurements (clock, gain) are left out, unless `measured`; so is the
    weather if `measured`.
    """
    kept = [
        own
        for own in tables
        if (measured and own.kind != "weather")
        or (not measured and own.kind not in OF_MEASUREMENTS)
    ]
    require(kept, "no unknown quantity; a table [[uncertainty.unknown]] expected")
    groups = [group.name for group in inputs.groups]
    windows = {}
    for own in kept:
        if own.kind in _WINDOW_KINDS and not own.material:
            windows[own.label] = _groups_of(own, groups)
    files = [own.files for own in kept if own.kind == "weather"]
    require(
        not files or study.weather.file is not None,
        'kind "weather" with clear skies; a weather file in [weather] expected',
    )
    return UnknownQuantities(
        tuple(_unknown(own, inputs.scene) for own in kept),
        {own.label: own.material for own in kept if own.material},
        windows,
        tuple(own.label for own in kept if own.kind == "sky"),
        tuple(own.label for own in kept if own.kind == "sun"),
        next((own.label for own in kept if own.kind == "weather"), ""),
        next((own.label for own in kept if own.kind == "clock"), ""),
        {own.label: own.grid for own in kept if own.kind == "gain"},
        {own.label: own for own in kept},
    )


def _groups_of(table: UnknownTable, groups: list[str]) -> tuple[int, ...]:
    what = f'quantity "{table.label}"'
    if not groups:
        expected = "a material of the scene"
        raise InputError(
            f"{what} acts on windows, but the study has none; {expected} expected"
        )
    if not table.window:
        return tuple(range(len(groups)))
    # A window file with several windows gives groups "name.window"
    found = tuple(
        number
        for number, name in enumerate(groups)
        if name == table.window or name.startswith(f"{table.window}.")
    )
    known = ", ".join(groups)
    require(found, f'{what} acts on window "{table.window}"; one of {known} expected')
    return found


def _unknown(table: UnknownTable, scene: Scene) -> Unknown:
    if table.kind == "weather":
        # The weather of the study is the first choice
        return Unknown(table.label, choice(len(table.files) + 1), 0.0)
    usual, reference = USUAL[table.kind], 0.0 if table.kind == "clock" else 1.0
    try:
        if table.material:
            (parameter,) = material_parameters(scene, [table.material])
            reference = parameter.value
            colour = scene.materials[table.material]
            usual = usual._replace(high=_highest(colour, reference, usual.high))
        shape = _distribution(table, usual, reference)
    except InputError as error:
        message = f'quantity "{table.label}": {error.message}'
        raise InputError(message) from error
    return Unknown(table.label, shape, reference, usual.unit)


def _highest(material: object, reference: float, limit: float) -> float:
    # Largest value at which no band of the colour exceeds the limit
    colour = getattr(material, "reflectance", getattr(material, "transmissivity", None))
    if colour is None or not np.max(colour) > 0:
        return limit
    return max(limit * reference / float(np.max(colour)), reference * 1.001)


def _distribution(table: UnknownTable, usual: Usual, reference: float) -> Distribution:
    if table.kind == "dirt" and table.low is None:
        return triangular(*USUAL_DIRT)
    low, high = usual.low, usual.high
    if table.low is not None and table.high is not None and table.shape != "normal":
        inside = low <= table.low and table.high <= high
        ends = f"range {table.low:g} to {table.high:g}"
        require(inside, f"{ends}; values from {low:g} to {high:.4g} expected")
        if table.shape == "uniform":
            return uniform(table.low, table.high)
        mode = reference if table.mode is None else table.mode
        return triangular(table.low, mode, table.high)
    scale = reference if usual.relative else 1.0
    return normal(
        reference if table.mean is None else table.mean,
        table.standard_deviation or usual.deviation * scale,
        low=low if table.low is None else max(low, table.low),
        high=high if table.high is None else min(high, table.high),
    )
