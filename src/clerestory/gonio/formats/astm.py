"""Data files of ASTM E1392: a header of keywords, then lines of angles and values.

    KEYWORD value
    VARS theta_i,phi_i,theta_s,phi_s,BRDF
    0.17,0.0,0.35,3.14,0.081

Angles are in radians, or in degrees if any angle exceeds 2π. Incident and scattered φ
are measured from the same axis: mirror reflection is at φ + 180°. Columns X, Y and Z
are read as three channels; other columns (R, G, B or wavelengths) are averaged.

References: ASTM E1392-96, "Standard practice for angle resolved optical scatter
measurements on specular or diffuse surfaces"; files of Cornell University's Light
Measurement Laboratory.
"""

import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.gonio.formats.columns import scans_of
from clerestory.gonio.formats.file_format import (
    FileFormat,
    ReadOptions,
    numbered_lines,
    table,
)
from clerestory.gonio.scattering_measurement import Measurement

_ANGLES = 4
_VARS = re.compile(r"^\s*VARS\s+", re.IGNORECASE)


def _read(path: Path, options: ReadOptions) -> Iterator[Measurement]:
    lines = numbered_lines(path)
    heads = [k for k, (_, text) in enumerate(lines) if _VARS.match(text)]
    require(heads, "no line starts with VARS; VARS and the column names expected")
    place, head = lines[heads[0]]
    names = [name.strip().lower() for name in _VARS.sub("", head).split(",")]
    names = [name for name in names if name]
    message = f"{len(names)} columns; four angles and one or more values expected"
    require(len(names) > _ANGLES, message, line=place)
    what = "four angles and BSDF values [1/sr]"
    data = table(lines[heads[0] + 1 :], columns=len(names), what=what)
    angles = data[:, :_ANGLES]
    if np.abs(angles).max() <= 2 * np.pi + 1e-6:
        angles = np.degrees(angles)
    function = options.function or "reflection_front"
    channels = {"visible": data[:, _ANGLES:].mean(axis=1)}
    if names[_ANGLES:] == ["x", "y", "z"]:
        x, y, z = data[:, _ANGLES:].T
        channels = {"visible": y, "cie-x": x, "cie-z": z}
    for channel, values in channels.items():
        scans = scans_of(np.column_stack([angles, values]), path)
        yield Measurement(scans, function, channel, name=path.stem)


FORMAT = FileFormat("astm", lambda head: head.has_line("vars"), _read)
