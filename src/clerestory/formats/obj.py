"""Reader of Wavefront OBJ files.

Facets are flat: smoothing groups and vertex normals are ignored.
"""

import warnings
from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.files import is_file, read_bytes, read_text
from clerestory.formats.obj_text import ObjPart, ObjText, parse_obj
from clerestory.scene.material import Source
from clerestory.scene.materials.plastic import Plastic
from clerestory.scene.model import Material, Scene, TriangleMesh, insert_material
from clerestory.scene.transform import number

# Key of the default material, for names that are not listed
ANY = "*"


def read_obj(
    path: str | Path,
    *,
    materials: Mapping[str, Material],
    colours: bool = False,
    scale: float = 1.0,
) -> Scene:
    r"""Return the triangles of an OBJ file as a scene.

    Parameters
    ----------
    path : path of the OBJ file
    materials : materials by name in `usemtl`, or by group name; "*" for all others
    colours : whether to create diffuse materials, with Kd of the file's material
        library (mtllib), for names that are not in `materials`
    scale : metres per unit of the file

    Raises
    ------
    InputError : the file is malformed, or has a material that is not in `materials`

    Examples
    --------
    >>> import tempfile
    >>> text = "v 0 0 0\nv 1 0 0\nv 1 1 0\ng desk\nusemtl wood\nf 1 2 3\n"
    >>> wood = Plastic("wood", np.array([0.4, 0.3, 0.2]))
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "desk.obj")
    ...     _ = file.write_text(text)
    ...     scene = read_obj(file, materials={"wood": wood})
    >>> scene.surfaces[0].name, scene.surfaces[0].material
    ('desk', 'wood')
    """
    text = parse_obj(read_bytes(path), file=str(path))
    given = dict(materials)
    if colours:
        given = _library(text, Path(path)) | given
    used: dict[str, Material] = {}
    surfaces = []
    for mesh, part in zip(obj_meshes(text, file=str(path)), text.parts, strict=True):
        material = _material(part, given, path)
        key = insert_material(used, material)
        with located(file=path, line=part.line):
            moved = replace(mesh, material=key, vertices=mesh.vertices * scale)
        surfaces.append(moved)
    require(surfaces, "no faces; a mesh expected", file=path)
    return Scene(used, tuple(surfaces))


def obj_meshes(text: ObjText, *, file: str) -> tuple[TriangleMesh, ...]:
    """Return a mesh for each `ObjPart`; the material is `usemtl` or the group name.

    Triangles of zero area are omitted, with a warning that gives their number.
    """
    made, flat = [], 0
    for part in text.parts:
        index, place = np.unique(part.faces, return_inverse=True)
        vertices, faces = text.vertices[index], place.reshape(-1, 3)
        corner = vertices[faces]
        doubled = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
        good = np.any(doubled != 0, axis=1)
        flat += int(np.count_nonzero(~good))
        made.append(
            TriangleMesh(
                vertices,
                faces[good],
                part.material or part.group,
                part.group or part.material,
                Source(file, part.line),
            )
        )
    if flat:
        message = f"{file}: {flat} triangles without area are omitted"
        warnings.warn(message, ClerestoryWarning, stacklevel=3)
    return tuple(made)


def _material(
    part: ObjPart, given: Mapping[str, Material], path: str | Path
) -> Material:
    for name in (part.material, part.group, ANY):
        if name and name in given:
            return given[name]
    what = f'material "{part.material}"' if part.material else f'group "{part.group}"'
    known = ", ".join(given) or "none"
    message = f"no material for {what}; given: {known} (`*` stands for any)"
    raise InputError(message, file=path, line=part.line)


def _library(text: ObjText, path: Path) -> dict[str, Material]:
    # Diffuse materials with the colours in the material libraries (mtllib)
    made: dict[str, Material] = {}
    for name in text.libraries:
        file = path.parent / name
        require(is_file(file), f'the library "{name}" is missing', file=path)
        current = ""
        for i, line in enumerate(read_text(file).splitlines(), start=1):
            words = line.split()
            if words[:1] == ["newmtl"]:
                current = " ".join(words[1:])
            elif words[:1] == ["Kd"] and current:
                colour = [number(word) for word in words[1:4]]
                values = [c for c in colour if c is not None and 0 <= c <= 1]
                message = f'colour "{line.strip()}"; three numbers from 0 to 1 expected'
                require(len(values) == 3, message, file=file, line=i)
                source = Source(str(file), i)
                made[current] = Plastic(current, np.array(values), source=source)
    return made
