"""Raw readings of the J&C RT-300S scatterometer in Excel 97 workbooks.

Each column is one reading. The rows give the azimuth A of the detector plane, the angle
of incidence I, the angle R of the detector and the reading RT relative to a white
standard: BRDF = RT / (π cos R). Mirror reflection is at R = I and A = −90°; φ = 90° + A
is measured from the azimuth of mirror reflection; the source is at φ = 180°.

Readings without a sample (the blank) must be subtracted. Without a blank file, negative
readings are kept. Near A = ±90° and R = −I the detector shades the source; these
readings are omitted.

References: M. Duque, thesis on the RT-300S, equation 4.6, and the processing of
ua-loft/bsdf-tools, process_rt300s.m.
"""

import io
import re
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xlrd
from jaxtyping import Float

from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.files import read_bytes
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.formats.file_format import FileFormat, ReadOptions
from clerestory.gonio.scattering_measurement import Measurement, Scan
from clerestory.gonio.symmetry import Symmetry

_ROWS = ("azimuth", "incidence", "receive", "rt")
# First bytes of Excel 97 workbooks, and pattern of sample rotation [°] in file names.
_WORKBOOK = b"\xd0\xcf\x11\xe0"
_ROTATION = re.compile(r"stageRotation(-?\d+)", re.IGNORECASE)

# Angles A and R [°] around the source within which the detector shades the source.
_SHADOW_AZIMUTH, _SHADOW_ANGLE = 30.0, 10.0

# Readings at larger detector angles [°] are omitted: the sample is seen edge-on.
_GRAZING = 89.0


def _read(path: Path, options: ReadOptions) -> Iterator[Measurement]:
    rotation = _ROTATION.search(path.name)
    turn = float(rotation[1]) if rotation else 0.0
    claimed: Symmetry | None = None if rotation else "isotropic"
    yield Measurement(
        tuple(_scans(path, turn, options.blank)),
        options.function or "reflection_front",
        name=path.stem,
        claimed=claimed,
        notes=() if options.blank else ("no blank reading was subtracted",),
    )


def _readings(path: Path) -> Float[np.ndarray, "4 readings"]:
    content = read_bytes(path)
    try:
        book = xlrd.open_workbook(file_contents=content, logfile=io.StringIO())
        with located(file=path):
            columns = [_sheet(sheet) for sheet in book.sheets() if sheet.ncols > 1]
    except InputError:
        raise
    except Exception as error:  # xlrd raises many kinds of exception
        reason = " ".join(str(error).split()) or type(error).__name__
        raise InputError(
            f"not an Excel 97 workbook ({reason[:80]}); an Excel 97 workbook expected",
            file=path,
        ) from error
    require(columns, "the workbook is empty; readings expected", file=path)
    data = np.concatenate(columns, axis=1)
    message = "a reading is not a number; numbers expected"
    require(np.all(np.isfinite(data)), message, file=path)
    return data


def _sheet(sheet: xlrd.sheet.Sheet) -> Float[np.ndarray, "4 readings"]:
    name = {
        str(sheet.cell_value(row, 0)).strip().lower(): row
        for row in reversed(range(sheet.nrows))
    }
    for row in _ROWS:
        message = f"sheet {sheet.name!r} has no row {row!r}; rows {', '.join(_ROWS)}"
        require(row in name, f"{message} expected")
    rows = [sheet.row_values(name[row])[1:] for row in _ROWS]
    return np.array(
        [[c if isinstance(c, (int, float)) else np.nan for c in row] for row in rows],
        dtype=float,
    )


def _scans(path: Path, turn: float, blank: Path | None) -> Iterator[Scan]:
    data = _readings(path)
    if blank is not None:
        empty = _readings(blank)
        require(
            empty.shape == data.shape and np.allclose(empty[:3], data[:3]),
            "the angles of blank and sample differ; equal angles expected",
        )
        data = np.concatenate([data[:3], data[3:] - empty[3:]])
    for incidence in np.unique(data[1]):
        message = f"angle of incidence is {incidence:g}°; 0 ≤ angle < 90° expected"
        require(0 <= incidence < 90, message)
        azimuth, _, receive, reading = data[:, data[1] == incidence]
        near_plane = np.abs(azimuth) >= 90 - _SHADOW_AZIMUTH
        from_source = np.abs(incidence - np.sign(azimuth) * receive)
        seen = ~(near_plane & (from_source <= _SHADOW_ANGLE))
        seen &= np.abs(receive) < _GRAZING
        azimuth, receive, reading = azimuth[seen], receive[seen], reading[seen]
        if not len(reading):
            continue
        brdf = reading / (np.pi * np.cos(np.radians(receive)))
        leaving = from_degrees(receive, 90 + azimuth - turn)
        yield Scan(from_degrees(float(incidence), 180 - turn), leaving, brdf, str(path))


FORMAT = FileFormat("rt300s", lambda head: head.data.startswith(_WORKBOOK), _read)
