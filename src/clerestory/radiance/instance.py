"""Instances and meshes: primitives that place the content of another file.

An `instance` refers to an octree. A frozen octree contains primitives; any other octree
names the scene files from which it was compiled. A `mesh` refers to a compiled mesh, or
to an OBJ file with material names that are modifiers of the scene.

References: G. Ward, "The RADIANCE 6.0 Synthetic Imaging System", section 2.1.
"""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.files import is_file, read_bytes
from clerestory.formats.obj import obj_meshes
from clerestory.formats.obj_text import ObjText, parse_obj
from clerestory.radiance.compiled import (
    CompiledMesh,
    Octree,
    read_compiled_mesh,
    read_octree,
)
from clerestory.radiance.placement import Placement
from clerestory.scene.model import Source, TriangleMesh
from clerestory.scene.primitive import Arguments, Primitive

INSTANCE_KINDS = frozenset({"instance", "mesh"})

_OBJ = ".obj"


@dataclass(frozen=True, eq=False)
class Instance:
    """The content of an instance or mesh: scene files to read, primitives and meshes.

    The modifier of `placement`, if any, replaces all materials.
    """

    files: tuple[Path, ...]
    items: tuple[Primitive | TriangleMesh, ...]
    placement: Placement


# Cache of parsed files by path
Loaded = dict[Path, Octree | ObjText | CompiledMesh]


def read_instance(
    item: Primitive, *, file: str, find: Callable[[str], Path], loaded: Loaded
) -> Instance:
    """Return the content of the file to which an instance or mesh primitive refers.

    `find` returns the path of a named file; `loaded` is the cache of parsed files.
    """
    given = Arguments(item, file)
    given.reals(0, strings=True)
    given.strings(1, "file name")
    modifier = None if item.modifier == "void" else item.modifier
    placement = Placement(given.transform(1), modifier, item.name)
    try:
        path = find(item.strings[0])
        if path not in loaded:
            loaded[path] = _load(path, item.kind)
        match loaded[path]:
            case Octree() as octree:
                return _octree(octree, path, placement, find)
            case ObjText() as text:
                meshes = obj_meshes(text, file=str(path))
                _require_materials(item, path, (mesh.material for mesh in meshes))
                return Instance((), meshes, placement)
            case CompiledMesh() as mesh:
                return Instance(
                    (), _compiled(mesh, path, item, given.source), placement
                )
    except InputError as error:
        if error.file is not None and str(error.file) != str(item.strings[0]):
            raise
        raise given.error(error.message) from error


def _load(path: Path, kind: str) -> Octree | ObjText | CompiledMesh:
    if kind == "instance":
        return read_octree(path)
    if path.suffix.lower() == _OBJ:
        return parse_obj(read_bytes(path), file=str(path))
    return read_compiled_mesh(path)


def _octree(
    octree: Octree, path: Path, placement: Placement, find: Callable[[str], Path]
) -> Instance:
    def found(name: str) -> Path:
        beside = path.parent / name
        return beside if is_file(beside) else find(name)

    with located(file=path):
        files = octree.scene_files(found)
    return Instance(files, octree.items, placement)


def _require_materials(item: Primitive, path: Path, names: Iterable[str]) -> None:
    require(
        all(names) or item.modifier != "void",
        f"{path} has faces without material; a modifier other than void expected",
    )


def _compiled(
    mesh: CompiledMesh, path: Path, item: Primitive, source: Source
) -> tuple[Primitive | TriangleMesh, ...]:
    _require_materials(item, path, mesh.material)
    names = np.array(mesh.material)
    parts: list[Primitive | TriangleMesh] = list(mesh.items)
    for name in np.unique(names).tolist():
        index, place = np.unique(mesh.faces[names == name], return_inverse=True)
        vertices, corners = mesh.vertices[index], place.reshape(-1, 3)
        parts.append(TriangleMesh(vertices, corners, name, name, source))
    return tuple(parts)
