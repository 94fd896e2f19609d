"""Writers of the files of a study: study file, window polygons, sensors."""

import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Vector
from clerestory.escaping import toml_value
from clerestory.files import write_text
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.materials.emitters import Glow
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.sensors import Sensors


def study_text(tables: Mapping[str, Any]) -> str:
    """Return the TOML text of a study.

    >>> print(study_text({"method": "2-phase", "sensors": [{"file": "desks.pts"}]}))
    method = "2-phase"
    <BLANKLINE>
    [[sensors]]
    file = "desks.pts"
    <BLANKLINE>
    """
    return "\n".join([*_lines(tables), ""])


def _lines(table: Mapping[str, Any], path: str = "") -> Iterator[str]:
    # TOML lines of a table: keys and values, followed by nested tables
    inner: list[tuple[str, Mapping[str, Any]]] = []
    for key, value in table.items():
        if isinstance(value, Mapping):
            inner.append((f"[{path}{key}]", value))
        elif isinstance(value, list) and value and isinstance(value[0], Mapping):
            inner += [(f"[[{path}{key}]]", each) for each in value]
        elif value != []:
            yield f"{key} = {toml_value(value)}"
    for head, each in inner:
        yield from ("", head, *_lines(each, f"{head.strip('[]')}."))


def window_text(
    name: str,
    outlines: Iterable[Float[np.ndarray, "_ 3"]],
    *,
    basis: str = "kf",
    up: Vector | None = None,
) -> str:
    """Return the Radiance text of a window group, with the comment for `rfluxmtx`.

    Outlines are counter-clockwise as seen from the room; `up` is +y of the BSDF.
    """
    polygons = [
        Polygon(vertices, name, f"{name}.{number}")
        for number, vertices in enumerate(outlines, start=1)
    ]
    scene = Scene({name: Glow(name, np.ones(3))}, tuple(polygons))
    axis = "" if up is None else " u=" + ",".join(f"{x:g}" for x in np.round(up, 6))
    return f"#@rfluxmtx h={basis}{axis}\n{format_rad(scene, bsdf_file={})}"


def write_sensors(path: Path, sensors: Sensors) -> Path:
    """Write a sensor file; return its path."""
    rows = np.concatenate([sensors.position, sensors.direction], axis=1)
    lines = (" ".join(f"{x:.7g}" for x in row) + "\n" for row in rows)
    write_text(path, "".join(lines))
    return path


def relative_path(file: str | Path, folder: Path) -> str:
    """Return a path relative to a folder, or an absolute path to another drive."""
    try:
        return Path(os.path.relpath(file, folder)).as_posix()
    except ValueError:
        return Path(file).resolve().as_posix()
