"""Solar optical properties of complex fenestration states, read from a model.

The matrices are those that EnergyPlus reads: BSDFs [1/sr] over exit patch and incident
patch, and absorptances of each layer by incident patch.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.energyplus.building_model import BuildingModel
from clerestory.energyplus.complex_fenestration import basis_rows
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition

STATE_CLASS = "Construction:ComplexFenestrationState"
_MATRIX = "Matrix:TwoDimension"
_BASES = ("full", "half", "quarter")
_MOST_LAYERS = 5


@dataclass(frozen=True, eq=False)
class ComplexOptics:
    """Solar optical properties of a complex fenestration state.

    Attributes
    ----------
    name : name of the construction
    partition : incident and exit patches
    transmission : BSDF of transmission from outdoors to indoors [1/sr]
    reflection_back : BSDF of reflection at the indoor side [1/sr]
    front, back : absorptance of each layer for light from outdoors and from indoors
    """

    name: str
    partition: RingPartition
    transmission: Float[np.ndarray, "exit incident"]
    reflection_back: Float[np.ndarray, "exit incident"]
    front: Float[np.ndarray, "layer incident"]
    back: Float[np.ndarray, "layer incident"]

    __repr__ = brief

    @property
    def transmittance(self) -> Values:
        """Directional-hemispherical transmittance by incident patch."""
        return np.asarray(self.partition.projected_solid_angles() @ self.transmission)

    def diffuse_back(self) -> tuple[float, Values]:
        """Return reflectance and absorptance of each layer for diffuse indoor light."""
        share = self.partition.projected_solid_angles() / np.pi
        reflected = self.partition.projected_solid_angles() @ self.reflection_back
        return float(reflected @ share), np.asarray(self.back @ share)


def complex_optics(building: BuildingModel, construction: str) -> ComplexOptics:
    """Read the solar properties of a complex fenestration state from a model.

    Raises
    ------
    InputError : the construction is of another class, a matrix is missing or has a
        wrong size, or the basis is none of the Klems bases
    """
    name, found = building.find(construction, STATE_CLASS)
    prefix = "solar_optical_complex_"

    def matrix(field: str) -> Float[np.ndarray, "row column"]:
        return _matrix(building, str(found.get(field, "")), f"{name}: {field}")

    basis = matrix("basis_matrix_name")
    partition = next(
        (p for p in map(klems, _BASES) if _same(basis, basis_rows(p))), None
    )
    message = f"{name}: a basis of {len(basis)} rings; Klems full, half or quarter"
    require(partition is not None, f"{message} expected", file=building.source)
    assert partition is not None
    sides: dict[str, list[np.ndarray]] = {"front": [], "back": []}
    for number in range(1, _MOST_LAYERS + 1):
        layer = "outside_layer" if number == 1 else f"layer_{number}"
        if found.get(f"{layer}_name"):
            for side, rows in sides.items():
                field = f"{layer}_directional_{side}_absorptance_matrix_name"
                rows.append(matrix(field).reshape(-1))
    optics = ComplexOptics(
        name,
        partition,
        matrix(f"{prefix}front_transmittance_matrix_name"),
        matrix(f"{prefix}back_reflectance_matrix_name"),
        np.array(sides["front"]),
        np.array(sides["back"]),
    )
    count = len(partition)
    sizes = {a.shape[-1] for a in (optics.transmission, optics.front, optics.back)}
    message = f"{name}: solar matrices of {sorted(sizes)} columns; {count} expected"
    require(sizes == {count}, message, file=building.source)
    return optics


def _same(basis: np.ndarray, known: np.ndarray) -> bool:
    return basis.shape == known.shape and bool(np.allclose(basis, known, atol=0.6))


def _matrix(
    building: BuildingModel, name: str, what: str
) -> Float[np.ndarray, "row column"]:
    _, found = building.find(name, _MATRIX)
    rows, columns = (int(found.get(f"number_of_{x}", 0)) for x in ("rows", "columns"))
    values = [each.get("value") for each in found.get("values", ())]
    sound = len(values) == rows * columns and all(
        isinstance(v, int | float) for v in values
    )
    message = f"{what}: {len(values)} numbers; {rows} × {columns} expected"
    require(sound, message, file=building.source)
    return np.array(values, dtype=float).reshape(rows, columns)
