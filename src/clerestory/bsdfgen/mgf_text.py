"""Geometry as text in MGF, the Materials and Geometry Format, for BSDF files.

Reference: G. Ward, "The Materials and Geometry Format", version 2, LBNL, 1996.
"""

from collections.abc import Iterator, Sequence

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Values
from clerestory.bsdfgen.shading_system import SampleArea
from clerestory.colorimetry import RADIANCE
from clerestory.escaping import mgf_name
from clerestory.scene.material import error_at
from clerestory.scene.materials.plastic import Roughness
from clerestory.scene.model import (
    Cone,
    Dielectric,
    Glass,
    Material,
    Metal,
    Mirror,
    Plastic,
    Polygon,
    Ring,
    Scene,
    Sphere,
    Surface,
    Trans,
)

# Thickness [m] to which the transmittance of solids in MGF refers.
_SOLID_THICKNESS = 0.005

_Colour = Float[np.ndarray, "3"]


def mgf_text(scene: Scene, area: SampleArea) -> str:
    """MGF text of a system in metres; the centre of the sample area is at x = y = 0."""
    lines = [f"xf -t {_numbers(-area.bounds[:, :2].mean(axis=0))} 0"]
    used = dict.fromkeys(surface.material for surface in scene.surfaces)
    names = {key: f"m{number}_{mgf_name(key)}" for number, key in enumerate(used)}
    for key, name in names.items():
        lines += [f"m {name} =", *_material(scene.materials[key])]
    current = ""
    for surface in scene.surfaces:
        if surface.material != current:
            current = surface.material
            lines.append(f"m {names[current]}")
        lines += [f"o {mgf_name(surface.name)}", *_surface(surface), "o"]
    return "\n".join([*lines, "xf"])


def _numbers(values: Sequence[float] | Values) -> str:
    return " ".join(f"{float(value):.9g}" for value in values)


def _material(material: Material) -> Iterator[str]:
    match material:
        case Plastic(up=None):
            diffuse = material.reflectance * (1 - material.specularity)
            yield from _share("rd", diffuse)
            if material.specularity > 0:
                white = np.full(3, material.specularity)
                yield from _share("rs", white, material.roughness)
        case Metal(up=None):
            yield from _share("rd", material.reflectance * (1 - material.specularity))
            shiny = material.reflectance * material.specularity
            yield from _share("rs", shiny, material.roughness)
        case Mirror():
            yield from _share("rs", material.reflectance, 0.0)
        case Trans(up=None):
            yield from _trans(material)
        case Glass():
            yield from _glass(material)
        case Dielectric():
            face = ((material.index - 1) / (material.index + 1)) ** 2
            passed = (1 - face) * material.transmissivity**_SOLID_THICKNESS
            yield from (f"\tir {material.index:.9g} 0", "\tsides 1")
            yield from _share("rs", np.full(3, face), 0.0)
            yield from _share("ts", passed, 0.0)
        case _:
            given = material.specification()
            kind = given.kind if given else type(material).__name__.lower()
            raise error_at(
                material.source,
                f'{kind} "{material.name}" cannot be expressed in MGF; omit the'
                " geometry from the BSDF",
            )


def _trans(material: Trans) -> Iterator[str]:
    rest = material.reflectance * (1 - material.specularity)
    passed = rest * material.transmission
    yield from _share("rd", rest - passed)
    yield from _share("td", passed * (1 - material.transmitted_specular))
    if material.specularity > 0:
        yield from _share("rs", np.full(3, material.specularity), material.roughness)
    if material.transmitted_specular > 0:
        through = passed * material.transmitted_specular
        yield from _share("ts", through, material.roughness)


def _glass(material: Glass) -> Iterator[str]:
    # Reflectance and transmittance of the pane (both surfaces) at normal incidence
    face = ((material.index - 1) / (material.index + 1)) ** 2
    inner = material.transmissivity
    series = 1 / (1 - (face * inner) ** 2)
    passed = (1 - face) ** 2 * inner * series
    yield f"\tir {material.index:.9g} 0"
    yield from _share("rs", face + face * inner * passed, 0.0)
    yield from _share("ts", passed, 0.0)


def _share(keyword: str, rgb: _Colour, *roughness: Roughness) -> Iterator[str]:
    # Write the colour, then the reflectance or transmittance
    xyz = RADIANCE.to_xyz() @ np.asarray(rgb, dtype=float)
    yield "\tc"
    if np.ptp(rgb) > 0:
        yield f"\t\tcxy {_numbers(xyz[:2] / xyz.sum())}"
    yield f"\t{keyword} {_numbers([xyz[1], *map(float, roughness)])}"


def _surface(surface: Surface) -> Iterator[str]:
    match surface:
        case Polygon():
            corners = surface.vertices
            for number, corner in enumerate(corners):
                yield from (f"v v{number} =", f"\tp {_numbers(corner)}")
            yield "f " + " ".join(f"v{number}" for number in range(len(corners)))
        case Sphere():
            yield from ("v v0 =", f"\tp {_numbers(surface.centre)}")
            yield f"sph v0 {-surface.radius if surface.inward else surface.radius:.9g}"
        case Cone():
            radii = np.array([surface.base_radius, surface.top_radius])
            radii = -radii if surface.inward else radii
            yield from ("v v0 =", f"\tp {_numbers(surface.base)}")
            yield from ("v v1 =", f"\tp {_numbers(surface.top)}")
            yield f"cone v0 {radii[0]:.9g} v1 {radii[1]:.9g}"
        case Ring():
            yield from ("v v0 =", f"\tp {_numbers(surface.centre)}")
            yield f"\tn {_numbers(surface.normal)}"
            yield f"ring v0 {surface.inner_radius:.9g} {surface.outer_radius:.9g}"
