"""Scenes for web viewers of VTK: .vtkjs files.

A .vtkjs file is a zip archive: `index.json` lists the datasets, camera and colour maps,
and a folder for each dataset contains its `index.json` and its arrays, little-endian.
ParaView Glance and the viewers of Ladybug Tools open such files.

References: Kitware, vtk.js: HttpSceneLoader and HttpDataSetReader.
"""

import hashlib
import json
import zipfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, final

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.files import replace_file
from clerestory.image.colour_scale import ColourScale

# Names of vtk.js for the types of arrays
_TYPES = {"<f4": "Float32Array", "<u4": "Uint32Array"}

# Scalar mode of mappers: cell data, chosen by the name of the array
_CELL_FIELD = 4

# Direction from the centre of the scene to the camera, and its distance in diagonals
_FROM, _DISTANCE = np.array([-0.5, -0.75, 0.7]), 1.8

# Number of colours of a colour map
_NODES = 33

# Colour and opacity of panes, and opacity of the room, which is seen from outside
_PANE, _PANE_OPACITY, _ROOM_OPACITY = (0.25, 0.7, 1.0), 0.4, 0.15

# Date of the members of the archive: that of the content is not known
_DATE = (1980, 1, 1, 0, 0, 0)


@final
@dataclass(frozen=True, eq=False)
class Surfaces:
    """Polygons with equal numbers of corners: one dataset of a scene.

    Attributes
    ----------
    name : name of the dataset
    corners : corners of the polygons [m]
    values : values of each polygon by name; the first one is shown as colour
    colour : RGB colour of surfaces without values, from 0 to 1
    opacity : from 0 to 1
    """

    name: str
    corners: Float[np.ndarray, "polygon corner 3"]
    values: Mapping[str, Float[np.ndarray, " polygon"]] = field(default_factory=dict)
    colour: tuple[float, float, float] = (0.8, 0.8, 0.8)
    opacity: float = 1.0


def room_surfaces(
    corners: Float[np.ndarray, "triangle 3 3"],
    colours: Float[np.ndarray, "triangle 3"],
    names: Sequence[str],
) -> list[Surfaces]:
    """Return a translucent dataset for each material, in its colour from 0 to 1."""
    material = np.array(names, dtype=object)
    found = []
    for name in dict.fromkeys(names):
        own = material == name
        r, g, b = colours[own][0].tolist()
        found.append(Surfaces(name, corners[own], {}, (r, g, b), _ROOM_OPACITY))
    return found


def pane_surfaces(name: str, corners: Float[np.ndarray, "triangle 3 3"]) -> Surfaces:
    """Return the transparent dataset of a window."""
    return Surfaces(name, corners, {}, _PANE, _PANE_OPACITY)


def write_vtkjs(
    path: str | Path,
    surfaces: Sequence[Surfaces],
    *,
    scales: Mapping[str, ColourScale] | None = None,
) -> None:
    """Write surfaces as a .vtkjs file.

    Parameters
    ----------
    path : file to write
    surfaces : datasets of the scene
    scales : colour scale of each array of values, by name

    Raises
    ------
    InputError : there are no polygons
    OutputError : the file cannot be written

    Examples
    --------
    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp(), "floor.vtkjs")
    >>> corners = np.array([[[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]])
    >>> floor = Surfaces("floor", corners, {"DA [%]": np.array([72.0])})
    >>> write_vtkjs(file, [floor])
    >>> [name for name in zipfile.ZipFile(file).namelist() if "data" not in name]
    ['index.json', '0/index.json']
    """
    shown = [each for each in surfaces if len(each.corners)]
    require(shown, "no surfaces; at least one expected", file=path)
    scene = {
        "version": 1,
        "background": [1, 1, 1],
        **_view(shown),
        "lookupTables": {
            name: _colour_map(name, scale) for name, scale in (scales or {}).items()
        },
        "scene": [_item(each, str(number)) for number, each in enumerate(shown)],
    }
    with (
        replace_file(path) as stream,
        zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive,
    ):
        _put(archive, "index.json", json.dumps(scene).encode())
        for number, each in enumerate(shown):
            _put_dataset(archive, str(number), each)


def _view(surfaces: Sequence[Surfaces]) -> dict[str, Any]:
    # Camera from above, with all surfaces that have values in view
    chosen = [each for each in surfaces if each.values] or surfaces
    points = np.concatenate([each.corners.reshape(-1, 3) for each in chosen])
    low, high = points.min(axis=0), points.max(axis=0)
    centre, diagonal = (low + high) / 2, float(np.linalg.norm(high - low))
    towards = _FROM / np.linalg.norm(_FROM)
    camera = {
        "focalPoint": centre.tolist(),
        "position": (centre + _DISTANCE * diagonal * towards).tolist(),
        "viewUp": [0, 0, 1],
    }
    return {"camera": camera, "centerOfRotation": centre.tolist()}


def _colour_map(name: str, scale: ColourScale) -> dict[str, Any]:
    # Nodes of a colour transfer function: value, red, green, blue, midpoint, sharpness
    place = np.linspace(0, 1, _NODES)
    ratio = scale.largest / scale.smallest if scale.logarithmic else 1.0
    values = (
        scale.smallest * ratio**place
        if scale.logarithmic
        else scale.smallest + place * (scale.largest - scale.smallest)
    )
    colours = scale.colours(place) / 255
    nodes = [
        [value, *colour, 0.5, 0.0]
        for value, colour in zip(values.tolist(), colours.tolist(), strict=True)
    ]
    return {
        "vtkClass": "vtkColorTransferFunction",
        "name": name,
        "nodes": nodes,
        "mappingRange": [scale.smallest, scale.largest],
    }


def _item(surfaces: Surfaces, url: str) -> dict[str, Any]:
    # Dataset in the list of the scene
    return {
        "name": surfaces.name,
        "type": "httpDataSetReader",
        "httpDataSetReader": {"url": url},
        "actor": {"origin": [0, 0, 0], "scale": [1, 1, 1], "position": [0, 0, 0]},
        "actorRotation": [0, 0, 0, 1],
        "mapper": {
            "colorByArrayName": next(iter(surfaces.values), ""),
            "scalarMode": _CELL_FIELD,
            "scalarVisibility": bool(surfaces.values),
        },
        "property": {
            "representation": 2,
            "edgeVisibility": 0,
            "diffuseColor": list(surfaces.colour),
            "opacity": surfaces.opacity,
        },
    }


def _put_dataset(archive: zipfile.ZipFile, folder: str, surfaces: Surfaces) -> None:
    count, corners, _ = surfaces.corners.shape
    number = np.arange(count * corners).reshape(count, corners)
    polygons = np.insert(number, 0, corners, axis=1)
    points = surfaces.corners.reshape(-1, 3).astype("<f4")

    def described(kind: str, name: str, values: np.ndarray) -> dict[str, Any]:
        flat = values.reshape(len(values), -1)
        components = 1 if kind == "vtkCellArray" else flat.shape[1]
        data = values.tobytes()
        key = hashlib.sha256(data).hexdigest()[:32]
        member = f"{folder}/data/{key}"
        if member not in archive.namelist():
            _put(archive, member, data)
        return {
            "vtkClass": kind,
            "name": name,
            "numberOfComponents": components,
            "dataType": _TYPES[values.dtype.str],
            "size": int(values.size),
            "ref": {"encode": "LittleEndian", "basepath": "data", "id": key},
        }

    arrays = [
        {"data": described("vtkDataArray", name, values.astype("<f4"))}
        for name, values in surfaces.values.items()
    ]
    dataset = {
        "vtkClass": "vtkPolyData",
        "points": described("vtkPoints", "points", points),
        "polys": described("vtkCellArray", "polys", polygons.astype("<u4")),
        "cellData": {"vtkClass": "vtkDataSetAttributes", "arrays": arrays},
    }
    _put(archive, f"{folder}/index.json", json.dumps(dataset).encode())


def _put(archive: zipfile.ZipFile, name: str, data: bytes) -> None:
    member = zipfile.ZipInfo(name, _DATE)
    member.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(member, data)
