"""BSDF generation by ray tracing of shading systems, as in Radiance's genBSDF.

Rays from each incident patch or cell, uniform in projected solid angle, enter the
sample area and are counted in their exit patch or cell. The sample area is a finite
sample or the unit cell of an infinite periodic system.
"""

import itertools
import warnings
from collections.abc import Mapping
from dataclasses import replace
from typing import Literal, Unpack

from clerestory.bands import RGB
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Geometry, Product
from clerestory.bsdf.scattering_function import OF_SIDE
from clerestory.bsdfgen.channel_weights import Weights, check_bands, default_weights
from clerestory.bsdfgen.geometry_checks import check_system
from clerestory.bsdfgen.mgf_text import mgf_text
from clerestory.bsdfgen.postprocessing import (
    one_transmission,
    reciprocal_with_errors,
    reduced,
)
from clerestory.bsdfgen.shading_system import SampleArea, System, area_of
from clerestory.bsdfgen.trace_matrices import trace_matrices
from clerestory.bsdfgen.trace_request import TraceRequest
from clerestory.bsdfgen.trace_trees import trace_trees
from clerestory.checks import one_of, require, within
from clerestory.engine import device as devices
from clerestory.engine.effort import EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.errors import ClerestoryWarning
from clerestory.hemisphere.klems import klems
from clerestory.scene.model import Scene

Basis = Literal["full", "half", "quarter", "tree3", "tree4"]
Sides = Literal["both", "front", "back"]

_BACKS: dict[str, tuple[bool, ...]] = {
    "both": (False, True),
    "front": (False,),
    "back": (True,),
}

_DEEPEST = 7

# Largest share of light beyond the incident light that can be Monte Carlo noise
_NOISE = 0.02

# Default number of paths if no number and no target error is given; as in genBSDF.
_DEFAULT = Goal(samples=2000)


def generate_bsdf(
    scene: Scene | System,
    *,
    basis: Basis = "full",
    halvings: int = 5,
    sides: Sides = "both",
    area: SampleArea | None = None,
    periodic: bool = False,
    bands: Mapping[str, Weights] | None = None,
    colour: bool = False,
    symmetry: bool = True,
    reciprocal: bool = False,
    reduction: float = 0.0,
    geometry: bool = True,
    name: str = "",
    **keywords: Unpack[EffortKeywords],
) -> Bsdf:
    """Calculate the BSDF of a shading system, with standard errors, by ray tracing.

    Coordinates are as in genBSDF: +x along the width, +y up, +z into the room, all
    geometry at z ≤ 0. *Front* is the outdoor side, as in BSDF files.

    Parameters
    ----------
    scene : geometry [m], or a parametric system
    basis : Klems basis, or tensor trees of rank 3 (isotropic systems) or 4
    halvings : resolution of trees: 2^halvings cells along each axis; 2 to 7
    sides : sides of incidence: "front" (outdoors), "back" (room) or "both"
    area : sample area; default: the bounding box of the scene
    periodic : whether the sample area is the unit cell of an infinite periodic system,
        so that no light is lost at the edges of the area
    bands : weights of the scene bands for each BSDF channel, by channel name; default:
        luminance and, unless the scene is in RGB, each band of the scene
    colour : whether to add channels CIE X and Z (trees: u' and v'); RGB scenes only
    samples : paths per incident patch, or mean number per smallest incident cell of a
        tree; default: 2000 unless `relative_error` is given
    relative_error : target error in place of `samples`: root mean square of the
        standard errors of all BSDF values, divided by the mean BSDF
    bounces : largest number of diffuse reflections of a path, as Radiance's -ab; None
        for no limit
    symmetry : whether to trace only one of several mirror-image incident patches;
        matrices only
    reciprocal : whether to average the BSDF with its reciprocal; meaningful only for
        periodic sample areas
    reduction : percentage of the blocks of smallest tree cells that are merged
    geometry : whether to include the geometry as MGF text; RGB scenes only
    name : product name
    seed : whole number ≥ 0; results are bitwise reproducible for a seed on one device
    device : compute device; "auto" selects a GPU if there is one
    progress : function called with the fraction done, 0…1, and a note

    Raises
    ------
    InputError : there is no geometry, the sample area is empty, a number is out of
        range, a solid is inside out, or the system emits more light than it receives
    DeviceError : there is no usable device

    Warns
    -----
    ClerestoryWarning : the geometry is doubtful, or the target error was not reached

    Examples
    --------
    >>> from clerestory.bsdfgen.panes_and_fabrics import diffuse_pane
    >>> sheet = diffuse_pane(transmittance=0.4, reflectance=0.3)
    >>> bsdf = generate_bsdf(sheet, basis="quarter", samples=256)
    >>> round(bsdf.diffuse("transmission_front"), 2)
    0.4
    """
    effort = effort_of(
        generate_bsdf,
        keywords,
        default=_DEFAULT,
        most_error=10.0,
        without=("batches", "components"),
    )
    system = _system(scene, area, periodic, bands, name)
    check_bands(system.bands, len(system.scene.bands))
    require(
        not colour or system.scene.bands == RGB,
        f"colour requested for a scene in {system.scene.bands}; a scene in {RGB}"
        " expected",
    )
    within(halvings, "halvings", least=2, most=_DEEPEST)
    one_of(sides, "sides", choices=_BACKS)
    require(
        0 <= reduction < 100,
        f"reduction is {reduction} %; 0 ≤ reduction < 100 expected",
    )
    for doubt in check_system(system.scene, system.area):
        warnings.warn(doubt, ClerestoryWarning, stacklevel=2)
    product = _product(system, geometry)
    request = TraceRequest(system, _BACKS[sides], colour, effort, symmetry)
    if basis in ("tree3", "tree4"):
        require(
            system.scene.bands == RGB,
            f"tensor trees of a scene in {system.scene.bands}; a matrix basis, or a"
            f" scene in {RGB}, expected",
        )
        engine = devices.load(effort.device, "sample_area_tree")
        traced = trace_trees(request, engine, rank=int(basis[-1]), depth=halvings)
    else:
        traced = trace_matrices(request, klems(basis))
    if not traced.reached:
        warnings.warn(
            f"the relative error {effort.relative_error} was not reached after"
            f" {traced.paths:,} paths; check the standard errors",
            ClerestoryWarning,
            stacklevel=2,
        )
    functions = traced.functions
    if reciprocal:
        functions = reciprocal_with_errors(functions)
    if basis == "tree4":
        functions = one_transmission(functions)
    if reduction > 0:
        functions = reduced(functions, reduction)
    made = Bsdf(functions, product)
    _require_energy(made)
    return made


def _require_energy(made: Bsdf) -> None:
    # Open or inverted solids can emit more light than they receive
    for channel, (side, parts) in itertools.product(made.channels, OF_SIDE.items()):
        known = all((channel, part) in made.functions for part in parts)
        if known and not channel.startswith("cie"):
            share = sum(made.diffuse(part, channel=channel) for part in parts)
            require(
                share < 1 + _NOISE,
                f"{share:.1%} of the light on the {side} leaves the system; 100 % at"
                " most expected: are dielectric solids closed, with outward normals?",
            )


def _system(
    scene: Scene | System,
    area: SampleArea | None,
    periodic: bool,
    bands: Mapping[str, Weights] | None,
    name: str,
) -> System:
    # Arguments override the area, bands and name of a parametric system
    if isinstance(scene, System):
        system = replace(scene, area=area or scene.area, bands=bands or scene.bands)
    else:
        system = System(
            scene, area or area_of(scene), bands or default_weights(scene.bands)
        )
    if periodic:
        system = replace(system, area=replace(system.area, periodic=True))
    if name:
        system = replace(system, product=replace(system.product, name=name))
    return system


def _product(system: System, geometry: bool) -> Product:
    width, height, _ = system.area.size.tolist()
    in_mgf = geometry and system.scene.bands == RGB
    text = mgf_text(system.scene, system.area) if in_mgf else ""
    return replace(
        system.product,
        thickness=system.area.thickness,
        width=system.product.width or width,
        height=system.product.height or height,
        geometry=Geometry(text) if text else None,
    )
