"""Parameters of a scene: the colours of its materials, each scaled by one number.

The value of a parameter is the photometric mean of the colour: of reflectance, or of
the transmissivity of glass. A material of several colours, a mixture or a BSDF has the
value 1, and the parameter scales all that it reflects and transmits.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Literal

import numpy as np

from clerestory.argument_types import checked_arguments
from clerestory.bands import Bands
from clerestory.checks import distinct, one_of, positive, require
from clerestory.errors import InputError
from clerestory.matrix.derivatives import Parameter
from clerestory.scene.material import (
    Colour,
    Emitter,
    Material,
    colours,
    parts,
    with_colours,
)
from clerestory.scene.materials.plastic import SMOOTHEST
from clerestory.scene.model import (
    BsdfSurface,
    Dielectric,
    FunctionSheet,
    Glass,
    Interface,
    Metal,
    Mirror,
    Mixture,
    Patterned,
    Plastic,
    Scene,
    Textured,
    Trans,
    Void,
)

# Relative change for which colours that act nonlinearly are compared
_STEP = 0.004

# Materials that scatter in proportion to a scale of all their data
_SCALED = BsdfSurface, FunctionSheet


@checked_arguments
def material_parameters(
    scene: Scene, names: Sequence[str] | Literal["all"]
) -> tuple[Parameter, ...]:
    """Return the parameters of materials of a scene, in the order of the names.

    Parameters
    ----------
    names : names of materials, or "all" for every material that scatters light and is
        used by a surface

    Raises
    ------
    InputError : no such material, or a light source, a refracting solid or a black
        material

    Examples
    --------
    >>> from clerestory.scene.model import Plastic, Scene
    >>> scene = Scene({"wall": Plastic("wall", np.full(3, 0.5))}, ())
    >>> material_parameters(scene, ["wall"])
    (Parameter(name='wall', value=0.5, quantity='reflectance'),)
    """
    if names == "all":
        used = {surface.material for surface in scene.surfaces}
        found = (name for name in scene.materials if name in used)
        names = [name for name in found if not _obstacle(scene.materials[name])]
    distinct(names, "materials")
    for name in names:
        one_of(name, "material", choices=list(scene.materials))
        obstacle = _obstacle(scene.materials[name])
        require(not obstacle, f'no derivative by the material "{name}": {obstacle}')
    return tuple(_parameter(name, scene.materials[name], scene.bands) for name in names)


def with_parameters(scene: Scene, values: Mapping[str, float]) -> Scene:
    """Return a scene with other values of the parameters of some materials.

    Raises
    ------
    InputError : no parameter of this name, a value of 0 or less, or a BSDF

    Examples
    --------
    >>> from clerestory.scene.model import Plastic, Scene
    >>> scene = Scene({"wall": Plastic("wall", np.full(3, 0.5))}, ())
    >>> with_parameters(scene, {"wall": 0.7}).materials["wall"].reflectance
    array([0.7, 0.7, 0.7])
    """
    materials = dict(scene.materials)
    for parameter in material_parameters(scene, tuple(values)):
        name, value = parameter.name, values[parameter.name]
        positive(value, f'{parameter.quantity} of "{name}"')
        if any(isinstance(part, _SCALED) for part in _every(materials[name])):
            raise InputError(
                f'the material "{name}" is a BSDF; the scene cannot be made with other'
                " values of a BSDF"
            )
        materials[name] = _scaled(materials[name], value / parameter.value)
    return replace(scene, materials=materials)


def compared_material(material: Material) -> tuple[Material, float] | None:
    """Return a material of less colour, and the relative change of the colour.

    The change is 1 (no colour) if the colour acts linearly. None: all that the material
    scatters is proportional to its parameter.
    """
    if is_proportional(material):
        return None
    nonlinear = any(isinstance(part, Glass) for part in _every(material))
    step = _STEP if nonlinear else 1.0
    return _scaled(material, 1 - step), step


def is_proportional(material: Material) -> bool:
    """Whether all that a material scatters is proportional to its parameter."""
    match material:
        case Plastic() | Trans():
            return material.specularity == 0
        case Metal():
            # A smooth coat reflects without colour at grazing angles
            return material.specularity == 0 or bool(
                np.min(material.roughness) > SMOOTHEST
            )
        case Mirror(alternate=None) | BsdfSurface() | FunctionSheet():
            return True
        case Patterned(base=base) | Textured(base=base):
            return is_proportional(base)
        case Mixture(foreground=one, background=other):
            return is_proportional(one) and is_proportional(other)
    return False


def _scaled(material: Material, factor: float) -> Material:
    return with_colours(material, lambda colour: colour * factor)


def _obstacle(material: Material) -> str:
    # Why there is no derivative by the parameter of a material
    kinds = [type(part) for part in _every(material)]
    if any(issubclass(kind, Emitter) for kind in kinds):
        return "it is a light source; a material that scatters light expected"
    if Dielectric in kinds or Interface in kinds:
        return "it is a refracting solid; an opaque material or a thin pane expected"
    if kinds == [Void]:
        return "it is void; a material that scatters light expected"
    if len(kinds) > 1 and any(issubclass(kind, _SCALED) for kind in kinds):
        if not isinstance(material, Patterned | Textured):
            return "it is a mixture with a BSDF; a BSDF alone expected"
    elif not isinstance(material, _SCALED) and not any(
        np.any(colour) for part in _every(material) for colour in colours(part)
    ):
        return "it is black; a value above 0 expected"
    return ""


def _every(material: Material) -> Iterator[Material]:
    # A material and the materials of which it is composed
    yield material
    for part in parts(material):
        yield from _every(part)


def _parameter(name: str, material: Material, bands: Bands) -> Parameter:
    base = material
    while isinstance(base, Patterned | Textured):
        base = base.base
    match base:
        case Plastic() | Metal() | Trans() | Mirror(alternate=None):
            return Parameter(name, _mean(base.reflectance, bands), "reflectance")
        case Glass():
            return Parameter(name, _mean(base.transmissivity, bands), "transmissivity")
    return Parameter(name, 1.0, "scale")


def _mean(colour: Colour, bands: Bands) -> float:
    if len(colour) != len(bands) or np.ptp(colour) == 0 or bands.efficacy is None:
        return float(np.mean(colour))
    return float(colour @ bands.shares)
