"""Conversion of a scene to a Mitsuba scene and device arrays.

Coordinates are translated so that the region of interest is at the origin: ray offsets
grow with the distance from the origin, and models far from their origin are common.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.bands import RGB
from clerestory.engine import materials
from clerestory.engine.analytic_shapes import analytic_shape, without_analytic
from clerestory.engine.channels import channels_of
from clerestory.engine.emitters import Emitters, split_by_surface
from clerestory.engine.origin import Origin
from clerestory.engine.scene_cache import cached
from clerestory.engine.upload import on_device
from clerestory.engine.windows import WindowTable, window_shapes
from clerestory.errors import InputError
from clerestory.scene.model import BsdfSurface, Emitter, Scene
from clerestory.scene.tessellate import Mesh, meshes
from clerestory.scene.window import Window

# Name prefixes of window and emitter shapes; the index follows.
_WINDOW, _LAMP, _PROXY, _LAYER = "window", "lamp", "proxy", "layer"


@dataclass
class LoweredScene:
    """A scene on the device.

    Attributes
    ----------
    scene : Mitsuba's scene
    window_of_shape : by Mitsuba shape index: 1 + window, or 0
    first_face : by Mitsuba shape index: index of the shape's first face in `reach`
    reach : largest coordinate of each face [m], to which rounding is proportional
    panes : whether shadow rays may be transmitted
    grey : whether all materials are grey, so that one channel is enough
    windows : tables of the receiving windows; None if there are none
    emitters : tables of emitting surfaces
    emitter_of_shape : by Mitsuba shape index: 1 + emitter, or 0
    thickness_of_shape : by Mitsuba shape index: thickness of proxied geometry behind
        (positive) or in front of (negative) a BSDF [m]; 0 for all other shapes
    layer_of_shape : by Mitsuba shape index: whether the material is a BSDF without
        thickness
    flags_of_shape : by Mitsuba shape index: BSDF flags of the material
    """

    scene: mi.Scene
    window_of_shape: mi.UInt32
    first_face: mi.UInt32
    reach: mi.Float
    panes: bool
    grey: bool
    windows: WindowTable | None
    emitters: Emitters
    emitter_of_shape: mi.UInt32
    thickness_of_shape: mi.Float
    layer_of_shape: mi.Bool
    flags_of_shape: mi.UInt32
    proxies: bool


def lower(
    scene: Scene,
    *,
    origin: Origin,
    receivers: tuple[Window, ...] = (),
) -> LoweredScene:
    """Return the device scene around `origin`, possibly cached from the previous job.

    Parameters
    ----------
    origin : point of the scene at the origin of device coordinates [m]
    receivers : windows that are surfaces of the scene and terminate paths

    Raises
    ------
    InputError : the scene does not have three channels; see `channels.band_groups`
    """
    if scene.bands != RGB:
        raise InputError(f"a scene in the bands {scene.bands}; {RGB} expected")
    key = mi.variant(), scene, tuple(origin.tolist()), receivers
    lowered: LoweredScene = cached(key, lambda: _lowered(scene, origin, receivers))
    return lowered


def _lowered(
    scene: Scene, origin: Origin, receivers: tuple[Window, ...]
) -> LoweredScene:
    materials.register()
    content: dict[str, object] = {"type": "scene"}
    shining: list[Mesh] = []
    thickness: list[float] = []
    flat, curved = without_analytic(scene)
    bsdfs = {
        name: materials.load(scene.materials[name], origin)
        for name in {surface.material for surface in curved}
    }
    for number, surface in enumerate(curved):
        content[f"round{number}"] = analytic_shape(
            surface, bsdfs[surface.material], origin
        )
    for number, mesh in enumerate(meshes(flat)):
        material = mesh.material
        bsdf = materials.load(material, origin)
        if isinstance(material, Emitter):
            for part in split_by_surface(mesh):
                name = f"{_LAMP}{len(shining)}"
                content[name] = _mesh(part.vertices - origin, part.faces, bsdf)
                shining.append(part)
            continue
        name = f"mesh{number}"
        if isinstance(material, BsdfSurface) and material.thickness:
            name = f"{_PROXY}{len(thickness)}"
            thickness.append(material.thickness)
        elif isinstance(material, BsdfSurface):
            name = f"{_LAYER}{number}"
        content[name] = _mesh(mesh.vertices - origin, mesh.faces, bsdf)
    black = materials.absorber()
    table, shapes = window_shapes(receivers, origin)
    for number, (vertices, faces) in enumerate(shapes):
        content[f"{_WINDOW}{number}"] = _mesh(vertices, faces, black)
    if len(content) == 1:
        # Mitsuba requires a shape: add a small triangle far below the scene
        corner = np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]]) - [0, 0, 1e4]
        content["nothing"] = _mesh(corner, np.array([[0, 1, 2]]), black)
    lowered = mi.load_dict(content)

    # Index the shapes that are windows, emitters or proxies, and the faces of all
    # shapes
    ids = dr.reinterpret_array(mi.UInt32, lowered.shapes_dr()).numpy()
    size = int(ids.max()) + 1
    windows, lamps, first_face = np.zeros((3, size), dtype=np.uint32)
    depth = np.zeros(size, dtype=np.float32)
    layer = np.zeros(size, dtype=bool)
    flags = np.zeros(size, dtype=np.uint32)
    reach: list[np.ndarray] = []
    panes = False
    for shape_id, shape in zip(ids, lowered.shapes(), strict=True):
        first_face[shape_id] = sum(len(faces) for faces in reach)
        reach.append(_reach(shape))
        flags[shape_id] = shape.bsdf().flags()
        panes |= mi.has_flag(shape.bsdf().flags(), mi.BSDFFlags.Null)
        kind = shape.id().rstrip("0123456789")
        number = int(shape.id()[len(kind) :] or 0)
        if kind == _WINDOW:
            windows[shape_id] = 1 + number
        elif kind == _LAMP:
            lamps[shape_id] = 1 + number
        elif kind == _PROXY:
            depth[shape_id] = thickness[number]
        elif kind == _LAYER:
            layer[shape_id] = True

    return LoweredScene(
        scene=lowered,
        window_of_shape=mi.UInt32(windows),
        first_face=mi.UInt32(first_face),
        reach=on_device(mi.Float, np.concatenate(reach)),
        panes=panes or bool(thickness),
        grey=channels_of(scene) == 1,
        windows=table,
        emitters=Emitters.of(shining, origin),
        emitter_of_shape=mi.UInt32(lamps),
        thickness_of_shape=mi.Float(depth),
        layer_of_shape=mi.Bool(layer),
        flags_of_shape=mi.UInt32(flags),
        proxies=bool(thickness),
    )


def _reach(mesh: mi.Shape) -> Float[np.ndarray, " faces"]:
    if not mesh.is_mesh():
        box = mesh.bbox()
        return np.array([np.abs([box.min, box.max]).max()])
    parameters = mi.traverse(mesh)
    vertices = np.abs(parameters["vertex_positions"].numpy().reshape(-1, 3))
    faces = parameters["faces"].numpy().reshape(-1, 3)
    return vertices.max(axis=1)[faces].max(axis=1)


def _mesh(
    vertices: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    bsdf: mi.BSDF,
) -> mi.Mesh:
    props = mi.Properties()
    props["bsdf"] = bsdf
    mesh = mi.Mesh("", len(vertices), len(faces), props=props)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = on_device(mi.Float, vertices)
    parameters["faces"] = on_device(mi.UInt32, faces)
    parameters.update()
    return mesh
