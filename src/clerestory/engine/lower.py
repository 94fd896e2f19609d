"""Lowering (conversion) of a scene to a Mitsuba scene and Dr.Jit arrays.

Coordinates are translated so that the region of interest is at the origin, because ray
offsets grow with the coordinates. Models far from their origin are common.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Int, Shaped

from clerestory.bands import RGB
from clerestory.engine import materials
from clerestory.engine.analytic_shapes import analytic_shape, without_analytic
from clerestory.engine.band_throughput import BandThroughput
from clerestory.engine.channels import at_two_reflectances, channels_of
from clerestory.engine.emitters import Emitters, split_by_surface
from clerestory.engine.origin import Origin
from clerestory.engine.scene_cache import cached
from clerestory.engine.smooth_faces import SmoothFaces
from clerestory.engine.upload import on_device
from clerestory.engine.windows import WindowTable, window_shapes
from clerestory.scene.model import BsdfSurface, Emitter, Scene
from clerestory.scene.tessellate import Mesh, meshes
from clerestory.scene.window import Window


@dataclass
class LoweredScene:
    """A scene on the compute device.

    Arrays named `…_of_shape` and `first_face` are indexed by Mitsuba's shape index.

    Attributes
    ----------
    window_of_shape, emitter_of_shape : 1 + index of the shape's window or emitter, or 0
    first_face : index of the shape's first face in `reach`
    reach : largest coordinate of each face [m]; rounding errors are proportional to it
    panes : whether any material transmits shadow rays
    grey : whether all materials are grey, so that one channel is enough
    thickness_of_shape : thickness of proxied geometry behind (positive) or in front of
        (negative) a BSDF [m]; 0 for all other shapes
    layer_of_shape : whether the material is a BSDF without thickness
    material_of_shape : name of the material; "" for emitters, windows, and shapes that
        are no meshes
    lambertian_of_shape : whether the material is Lambertian
    name_of_shape : as `material_of_shape`, also for shapes that are no meshes
    proxies : whether any shape has a thickness
    smooth : faces that reflect like a mirror
    throughput : throughput of paths in the bands of a coloured scene with bands other
        than RGB; None for three channels
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
    material_of_shape: Shaped[np.ndarray, " shape"]
    name_of_shape: Shaped[np.ndarray, " shape"]
    flags_of_shape: mi.UInt32
    lambertian_of_shape: mi.Bool
    proxies: bool
    smooth: SmoothFaces
    throughput: BandThroughput | None = None

    def of_materials(self, names: Sequence[str]) -> mi.Bool:
        """Return whether the material of each shape has one of the names."""
        return on_device(mi.Bool, np.isin(self.material_of_shape, names))

    def uniform(self, throughput):
        """Return the throughput of a path before it is scattered, in its channels."""
        if self.throughput is None:
            return mi.Color3f(throughput)
        return self.throughput.uniform(throughput)


def lower(
    scene: Scene,
    *,
    origin: Origin,
    receivers: tuple[Window, ...] = (),
    illuminated: bool = False,
) -> LoweredScene:
    """Return the lowered scene around `origin`, possibly cached from the previous job.

    The windows `receivers` become surfaces of the scene at which paths end. The scene
    is in RGB, or its bands share paths; see `channels`. An `illuminated` scene is
    cached apart, since its BSDFs are sampled by the light of the scene
    (`light_behind_layers`).
    """
    key = mi.variant(), scene, tuple(origin.tolist()), receivers, illuminated
    lowered: LoweredScene = cached(key, lambda: _lowered(scene, origin, receivers))
    return lowered


def _lowered(
    scene: Scene, origin: Origin, receivers: tuple[Window, ...]
) -> LoweredScene:
    materials.register()
    spectral = None if scene.bands == RGB else scene
    scene = scene if spectral is None else at_two_reflectances(scene)
    content: dict[str, object] = {"type": "scene"}
    shining: list[Mesh] = []
    thickness: dict[str, float] = {}
    layers: set[str] = set()
    material_names: dict[str, str] = {}
    names_of_colours: dict[str, str] = {}
    smooth: dict[str, Mesh] = {}
    flat, curved = without_analytic(scene)
    bsdfs = {
        name: materials.load(scene.materials[name], origin)
        for name in {surface.material for surface in curved}
    }
    for number, surface in enumerate(curved):
        shape = analytic_shape(surface, bsdfs[surface.material], origin)
        content[f"round{number}"] = shape
        names_of_colours[f"round{number}"] = surface.material
    for number, mesh in enumerate(meshes(flat)):
        material, name = mesh.material, f"mesh{number}"
        bsdf = materials.load(material, origin)
        if isinstance(material, Emitter):
            for part in split_by_surface(mesh):
                lamp = f"lamp{len(shining)}"
                content[lamp] = _mesh(part.vertices - origin, part.faces, bsdf)
                shining.append(part)
            continue
        if isinstance(material, BsdfSurface) and material.thickness:
            thickness[name] = material.thickness
        elif isinstance(material, BsdfSurface):
            layers.add(name)
        elif material.mirrored > 0:
            smooth[name] = mesh
        material_names[name] = flat.surfaces[mesh.surface[0]].material
        content[name] = _mesh(mesh.vertices - origin, mesh.faces, bsdf)
    black = materials.absorber()
    table, shapes = window_shapes(receivers, origin)
    for number, (vertices, faces) in enumerate(shapes):
        content[f"window{number}"] = _mesh(vertices, faces, black)
    if len(content) == 1:
        # Mitsuba requires a shape: add a small triangle far below the scene
        corner = np.array([[0, 0, 0], [1e-3, 0, 0], [0, 1e-3, 0]]) - [0, 0, 1e4]
        content["nothing"] = _mesh(corner, np.array([[0, 1, 2]]), black)
    lowered = mi.load_dict(content)

    def by_index(values: list) -> np.ndarray:
        # Array of one value per shape, by Mitsuba's shape index
        found = np.zeros(int(ids.max()) + 1, dtype=np.asarray(values).dtype)
        found[ids] = values
        return found

    def by_shape(kind: type, values: list):
        return on_device(kind, by_index(values))

    # Number the shapes that are windows or emitters, and the faces of all shapes
    ids = dr.reinterpret_array(mi.UInt32, lowered.shapes_dr()).numpy()
    names = [shape.id() for shape in lowered.shapes()]
    lamps = {f"lamp{number}": 1 + number for number in range(len(shining))}
    windows = {f"window{number}": 1 + number for number in range(len(shapes))}
    reach = [_reach(shape) for shape in lowered.shapes()]
    faces = np.array([len(part) for part in reach])
    first = dict(zip(names, np.cumsum(faces) - faces, strict=True))
    names_of_colours |= material_names
    colours_of = [names_of_colours.get(name, "") for name in names]
    mirrors = [(first[name], mesh) for name, mesh in smooth.items()]
    flags = [+shape.bsdf().flags() for shape in lowered.shapes()]
    return LoweredScene(
        scene=lowered,
        window_of_shape=by_shape(mi.UInt32, [windows.get(name, 0) for name in names]),
        first_face=by_shape(mi.UInt32, [first[name] for name in names]),
        reach=on_device(mi.Float, np.concatenate(reach)),
        panes=bool(thickness) or any(flag & +mi.BSDFFlags.Null for flag in flags),
        grey=channels_of(scene) == 1,
        windows=table,
        emitters=Emitters.of(shining, origin),
        emitter_of_shape=by_shape(mi.UInt32, [lamps.get(name, 0) for name in names]),
        thickness_of_shape=by_shape(mi.Float, [thickness.get(n, 0.0) for n in names]),
        layer_of_shape=by_shape(mi.Bool, [name in layers for name in names]),
        material_of_shape=by_index([material_names.get(n, "") for n in names]),
        name_of_shape=by_index(colours_of),
        flags_of_shape=by_shape(mi.UInt32, flags),
        lambertian_of_shape=by_shape(
            mi.Bool,
            [bool(n) and scene.materials[n].lambertian for n in colours_of],
        ),
        proxies=bool(thickness),
        smooth=SmoothFaces.of(int(faces.sum()), mirrors, origin),
        throughput=BandThroughput.of(spectral, by_index(colours_of)),
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
