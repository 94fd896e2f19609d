"""Files of pab-opto's goniophotometer pgII, written by the program Mountain.

Lines that start with # hold the header; all other lines hold θ, φ and a value, or three
values for CIE X, Y and Z. Each file contains one incident direction. θ is measured from
the normal of the sample, from 0 to 180°; φ runs anticlockwise as seen from the tip of
the normal. "upphi" is the φ of the up direction. Values are BSDF, or DSF: BSDF times
the cosine of θ.

The normal of the sample points to the room, or optionally to the sky; in the latter
case directions are rotated by 180° about the up axis.

Reference: manual page of Radiance's pabopto2bsdf, version 6.0a.
"""

import functools
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clerestory.array_types import Directions, Points2, Vector
from clerestory.bsdf.scattering_function import OF_SIDE, Function, Side
from clerestory.checks import require
from clerestory.gonio.angles import from_degrees, upper_hemisphere
from clerestory.gonio.formats.file_format import (
    Facing,
    FileFormat,
    Line,
    ReadOptions,
    check_angles,
    number,
    numbered_lines,
    table,
)
from clerestory.gonio.scattering_measurement import Measurement, Scan

_KINDS = ("DSF", "BSDF", "BRDF", "BTDF")
_CHANNELS = {"cie-y": ("visible",), "cie-xyz": ("cie-x", "visible", "cie-z")}
_NAME = re.compile(r'sample_name\s*:?\s*"([^"]*)"')

# Directions within this angle of the sample plane [°] are ignored in deciding between
# reflection and transmission.
_GRAZING_DEG = 1e-3


@dataclass
class _Header:
    # Angles [°], BSDF or DSF, colorimetry and sample name; None or empty if missing
    theta: float | None = None
    phi: float | None = None
    up: float = 0.0
    kind: str = ""
    colour: str = "cie-y"
    name: str = ""


def _read(path: Path, options: ReadOptions) -> Iterator[Measurement]:
    lines = numbered_lines(path)
    header = _header(lines)
    message = "no incident direction; #intheta and #inphi, or #incident_angle, expected"
    require(None not in (header.theta, header.phi), message)
    message = 'no format line; "#format: theta phi BSDF" (or DSF) expected'
    require(header.kind, message)
    channels = _CHANNELS[header.colour]
    what = f"θ, φ [°] and {len(channels)} values"
    data = table(lines, columns=2 + len(channels), what=what)
    incident = np.array([[header.theta, header.phi]], dtype=float)
    check_angles(incident[:, 0], most=180, what="incident θ")
    check_angles(data[:, 0], most=180)
    source = _turn(incident, header.up, options.facing)[0]
    leaving = _turn(data[:, :2], header.up, options.facing)
    function = _function(source, leaving)
    shade = np.maximum(np.abs(leaving[:, 2]), 1e-6) if header.kind == "dsf" else 1.0
    source, leaving = upper_hemisphere(source), upper_hemisphere(leaving)
    for channel, values in zip(channels, data[:, 2:].T, strict=True):
        scan = Scan(source, leaving, values / shade, str(path))
        yield Measurement((scan,), function, channel, header.name)


def _header(lines: list[Line]) -> _Header:
    header, angle = _Header(), functools.partial(number, what="an angle [°]")
    for place, line in lines:
        text = line.strip()
        if not text.startswith("#"):
            continue
        words = text[1:].replace(":", " ").split()
        key = words[0].lower() if words else ""
        if key == "incident_angle" and len(words) >= 3:
            header.theta, header.phi = (angle(word, line=place) for word in words[1:3])
        elif key in ("intheta", "inphi", "upphi") and len(words) >= 2:
            name = {"intheta": "theta", "inphi": "phi", "upphi": "up"}[key]
            setattr(header, name, angle(words[1], line=place))
        elif key == "format" and [w.lower() for w in words[1:3]] == ["theta", "phi"]:
            header.kind = words[-1].lower()
            message = f"format is {words[-1]!r}; one of {', '.join(_KINDS)} expected"
            require(header.kind.upper() in _KINDS, message, line=place)
        elif key == "colorimetry" and len(words) >= 2:
            header.colour = words[1].lower()
            message = f"colorimetry is {words[1]!r}; CIE-Y or CIE-XYZ expected"
            require(header.colour in _CHANNELS, message, line=place)
        elif key == "sample_name" and (found := _NAME.search(text)):
            header.name = found[1]
    return header


def _turn(angles: Points2, up: float, facing: Facing) -> Directions:
    # Convert to window coordinates: up at φ = 90°, normal towards the room
    theta, phi = angles.T
    if facing == "sky":
        return from_degrees(180 - theta, 90 - (phi - up))
    return from_degrees(theta, 90 + (phi - up))


def _function(source: Vector, leaving: Directions) -> Function:
    side: Side = "back" if source[2] > 0 else "front"
    grazing = np.sin(np.radians(_GRAZING_DEG))
    above, below = np.any(leaving[:, 2] > grazing), np.any(leaving[:, 2] < -grazing)
    require(
        not (above and below),
        "scattered directions lie on both sides of the sample; one side per file"
        " expected; are the columns of θ and φ swapped?",
    )
    transmission, reflection = OF_SIDE[side]
    return reflection if bool(above) == (side == "back") else transmission


# Keys of header lines, with and without a space after the #
_KEYS = ("format", "intheta", "incident_angle", "inphi", "colorimetry")
_STARTS = tuple(f"#{space}{key}" for key in _KEYS for space in ("", " "))

FORMAT = FileFormat("pabopto", lambda head: head.has_line(*_STARTS), _read)
