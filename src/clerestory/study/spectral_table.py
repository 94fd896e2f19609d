"""Table of the spectral quantities at eyes, a line for each eye and lit time step."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from clerestory.escaping import csv_line
from clerestory.files import replace_file
from clerestory.spectral.alpha_opic import EML_PER_EDI
from clerestory.study.results import Results

# Columns of quantities of colour: result variable, heading, decimals
_COLOUR = (
    ("colour_temperature", "CCT [K]", 0),
    ("colour_temperature_error", "CCT standard error [K]", 1),
    ("duv", "Duv", 5),
    ("colour_rendering", "Ra", 1),
    ("colour_rendering_error", "Ra standard error", 2),
    ("colour_rendering_red", "R9", 1),
)
_TOTAL = (
    ("total_colour_temperature", "CCT with electric light [K]", 0),
    ("total_duv", "Duv with electric light", 5),
    ("total_colour_rendering", "Ra with electric light", 1),
)


def write_spectra(results: Results, path: str | Path) -> None:
    """Write illuminance, α-opic EDI, EML, CCT, Duv and colour rendering of each eye.

    Luminaires with spectra add columns with electric light. Time steps without light
    have no line; undefined values are empty.
    """
    data = results.data
    receptors = data["photoreceptor"].values.tolist()
    heads = ["eye", "time", "illuminance [lux]"]
    heads += [f"{name.replace('_', '-')} EDI [lux]" for name in receptors]
    heads += ["melanopic EDI standard error [lux]", "EML [lux]"]
    heads += [heading for name, heading, _ in _COLOUR if name in data]
    if "total_edi" in data:
        heads.append("melanopic EDI with electric light [lux]")
        heads += [heading for name, heading, _ in _TOTAL if name in data]
    with replace_file(path) as stream:
        stream.write(f"{csv_line(heads)}\n".encode())
        stream.writelines(f"{line}\n".encode() for line in _lines(data))


def _lines(data: xr.Dataset) -> Iterator[str]:
    stamps = np.datetime_as_string(data["time"].values, unit="m").tolist()
    for number, eye in enumerate(data["eye"].values.tolist()):
        part = data.isel(eye=number)
        edi = part["edi"].values
        melanopic = part["photoreceptor"].values.tolist().index("melanopic")
        error = part["edi_error"].values[melanopic]
        columns = [part["eye_illuminance"].values, *edi, error]
        columns.append(EML_PER_EDI * edi[melanopic])
        shown = [(column, 1) for column in columns]
        shown += [(part[n].values, d) for n, _, d in _COLOUR if n in part]
        lit = columns[0] > 0
        if "total_edi" in part:
            total = part["total_edi"].values[melanopic]
            lit = lit | (total > 0)
            shown.append((total, 1))
            shown += [(part[n].values, d) for n, _, d in _TOTAL if n in part]
        for step in np.flatnonzero(lit).tolist():
            cells = [_cell(float(column[step]), digits) for column, digits in shown]
            yield csv_line([eye, stamps[step].replace("T", " "), *cells])


def _cell(value: float, digits: int) -> str:
    return f"{value:.{digits}f}" if np.isfinite(value) else ""
