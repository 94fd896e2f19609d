"""A scene of plain values becomes a Mitsuba scene and the tables kernels need.

Coordinates are moved so that the region of interest lies at the origin: ray
offsets grow with the distance from it, and models far from their origin are
common.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int

from clerestory.engine import materials
from clerestory.engine.windows import WindowTable, window_shapes
from clerestory.scene.model import Glass, Plastic, Scene
from clerestory.scene.tessellate import meshes
from clerestory.scene.window import Window

# Shapes that are windows carry this name and their number.
_WINDOW = "window"


@dataclass
class LoweredScene:
    """A scene on the device.

    Attributes
    ----------
    scene : Mitsuba's scene
    window_of_shape : by Mitsuba's shape number: 1 + window, or 0
    first_face : by Mitsuba's shape number: where its faces begin in `reach`
    reach : of each face, its largest coordinate [m], which its rounding grows with
    panes : whether there is glass, through which shadow rays must look
    grey : whether all materials are, so that one channel says all
    windows : tables of the receiving windows, None without any
    """

    scene: mi.Scene
    window_of_shape: mi.UInt32
    first_face: mi.UInt32
    reach: mi.Float
    panes: bool
    grey: bool
    windows: WindowTable | None


def lower(
    scene: Scene,
    *,
    origin: Float[np.ndarray, "3"],
    receivers: tuple[Window, ...] = (),
) -> LoweredScene:
    """Build the device's scene around `origin`.

    Parameters
    ----------
    origin : point of the scene that comes to lie at the device's origin [m]
    receivers : windows that are surfaces of the scene and end the paths that meet them
    """
    materials.register()
    content: dict[str, object] = {"type": "scene"}
    for number, mesh in enumerate(meshes(scene)):
        bsdf = mi.load_dict(materials.plugin(mesh.material))
        content[f"mesh{number}"] = _mesh(mesh.vertices - origin, mesh.faces, bsdf)
    black = materials.absorber()
    table, shapes = window_shapes(receivers, origin)
    for number, (vertices, faces) in enumerate(shapes):
        content[f"{_WINDOW}{number}"] = _mesh(vertices, faces, black)
    if len(content) == 1:
        # Mitsuba wants a shape: one small triangle, far below everything
        corner = np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]]) - [0, 0, 1e4]
        content["nothing"] = _mesh(corner, np.array([[0, 1, 2]]), black)
    lowered = mi.load_dict(content)

    # Number the shapes that are windows, and the faces of all shapes
    ids = dr.reinterpret_array(mi.UInt32, lowered.shapes_dr()).numpy()
    roles, first_face = np.zeros((2, int(ids.max()) + 1), dtype=np.uint32)
    reach: list[np.ndarray] = []
    for shape_id, shape in zip(ids, lowered.shapes(), strict=True):
        first_face[shape_id] = sum(len(faces) for faces in reach)
        reach.append(_reach(shape))
        if shape.id().startswith(_WINDOW):
            roles[shape_id] = 1 + int(shape.id().removeprefix(_WINDOW))

    used = list(scene.materials.values())
    return LoweredScene(
        scene=lowered,
        window_of_shape=mi.UInt32(roles),
        first_face=mi.UInt32(first_face),
        reach=mi.Float(np.concatenate(reach)),
        panes=any(isinstance(m, Glass) for m in used),
        grey=all(_is_grey(m) for m in used),
        windows=table,
    )


def _reach(mesh: mi.Mesh) -> Float[np.ndarray, " faces"]:
    parameters = mi.traverse(mesh)
    vertices = np.abs(parameters["vertex_positions"].numpy().reshape(-1, 3))
    faces = parameters["faces"].numpy().reshape(-1, 3)
    return vertices.max(axis=1)[faces].max(axis=1)


def _is_grey(material) -> bool:
    match material:
        case Plastic():
            return bool(np.ptp(material.reflectance) == 0)
        case Glass():
            return bool(np.ptp(material.transmissivity) == 0)
    return True


def _mesh(
    vertices: Float[np.ndarray, "vertices 3"],
    faces: Int[np.ndarray, "faces 3"],
    bsdf: mi.BSDF,
) -> mi.Mesh:
    props = mi.Properties()
    props["bsdf"] = bsdf
    mesh = mi.Mesh("", len(vertices), len(faces), props=props)
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = mi.Float(vertices.astype(np.float32).ravel())
    parameters["faces"] = mi.UInt32(faces.astype(np.uint32).ravel())
    parameters.update()
    return mesh
