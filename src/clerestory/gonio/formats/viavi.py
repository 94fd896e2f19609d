"""Text files of RPC Photonics' scatterometer: one incident direction a file.

Two lines that start with !! are followed by the incident angles and by lines of θ, φ
and BSDF [1/sr]. Light that goes straight on, or that a mirror would send, leaves at the
φ of the incident light: the source stands opposite. Whether the values are of
reflection or transmission is not said.

Reference: files of the engineered diffuser EDS10 in ua-loft/bsdf-tools, and Photon
Engineering's article 304 on them.
"""

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.formats.number_table import check_angles, table
from clerestory.gonio.scattering_measurement import Measurement, Scan

_MARK = "!!"


def read_viavi(
    paths: Sequence[Path], *, function: Function = "transmission_front"
) -> tuple[Measurement, ...]:
    """Return the measurement in files of one sample.

    Raises
    ------
    InputError : a file is not of this format
    """
    scans = tuple(_read(path) for path in paths)
    head = read_text(paths[0]).lstrip(_MARK).split()
    return (Measurement(scans, function, name=head[0] if head else ""),)


def _read(path: Path) -> Scan:
    lines = list(enumerate(read_text(path).splitlines(), 1))
    body = [(k, text) for k, text in lines if text.strip() and _MARK not in text[:2]]
    if len(body) == len(lines) or not body:
        raise InputError(
            "no line that starts with !!; a scatterometer's file expected", file=path
        )
    incident = table(body[:1], columns=2, what="incident θ and φ [°]", file=path)[0]
    data = table(body[1:], columns=3, what="θ, φ [°] and BSDF [1/sr]", file=path)
    check_angles(incident[:1], most=90, file=path, what="incident θ")
    check_angles(data[:, 0], most=90, file=path)
    theta, phi, value = data.T
    source = from_degrees(float(incident[0]), float(incident[1]) + 180)
    return Scan(source, from_degrees(np.minimum(theta, 89.99), phi), value, str(path))
