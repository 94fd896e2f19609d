"""Reader of glazing products in the text format of LBNL Optics (.dat, .usr).

Lines in braces describe the product. All other lines are rows of four columns
(wavelength, transmittance, front and back reflectance) or nine columns (wavelength,
then front and back transmittance and reflectance, each direct and diffuse).
"""

import re
from dataclasses import replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.checks import finite, require
from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import GLASS_CONDUCTIVITY, GLASS_EMISSIVITY, Pane
from clerestory.spectra import wavelength_unit_nm

_BRACES = re.compile(r"\{([^}]*)\}(.*)")
_NUMBER = re.compile(r"[-+]?\d*\.?\d+(?:[eE][-+]?\d+)?")
_COATED = ("coated", "applied film", "laminate", "film", "chromic")
_MILLIMETRE = 1e-3


def read_optics_file(path: str | Path) -> Pane:
    """Return the pane that a file in the LBNL Optics format describes."""
    header: dict[str, str] = {}
    rows: list[list[float]] = []
    for number, line in enumerate(read_text(path).splitlines(), start=1):
        found = _BRACES.match(line.strip())
        if found:
            _note(found[1], found[2].strip(), header)
        elif line.strip():
            rows.append(_row(line, number, path, rows))
    with located(file=path):
        require(rows, "no rows of wavelength and optical properties; some expected")
        return _pane(np.array(rows), header, path)


def _note(inside: str, after: str, header: dict[str, str]) -> None:
    # Headers are written as "{ Product Name: Clear }" or "{ Thickness } 3.048"
    key, colon, value = inside.partition(":")
    header[key.strip().lower()] = value.strip() if colon else after


def _row(
    line: str, number: int, path: str | Path, rows: list[list[float]]
) -> list[float]:
    words = line.replace(",", " ").split()
    try:
        row = [float(word) for word in words]
    except ValueError:
        row = []
    counts = (len(rows[0]),) if rows else (4, 9)
    columns = " or ".join(map(str, counts))
    message = f"{line.strip()[:60]!r}; {columns} numbers expected"
    require(len(row) in counts, message, file=path, line=number)
    return row


def _pane(
    table: Float[np.ndarray, "row column"], header: dict[str, str], path: str | Path
) -> Pane:
    table = table[np.argsort(table[:, 0], kind="stable")]
    units = header.get("units, wavelength units", "SI Microns").split()
    unit = wavelength_unit_nm(units[-1] if units else "")
    if unit is None:
        raise InputError(
            f"wavelength unit {units[-1]!r}; microns or nanometers expected"
        )
    emissivity = _numbers(header.get("emissivity, front back", ""))
    front, back = (*emissivity, GLASS_EMISSIVITY, GLASS_EMISSIVITY)[:2]
    kind = header.get("type", "").lower()
    side = header.get("coated side", "neither").lower()
    pane = Pane(
        name=header.get("product name", "") or Path(path).stem,
        wavelength_nm=table[:, 0] * unit,
        direct=Optics(*_columns(table, diffuse=False)),
        coated=any(word in kind for word in _COATED),
        thickness=_first(header, "thickness", 3.0) * _MILLIMETRE,
        conductivity=_first(header, "conductivity", GLASS_CONDUCTIVITY),
        emissivity_front=front,
        emissivity_back=back,
        infrared_transmittance=_first(header, "ir transmittance", 0.0),
        coated_side=side if side in ("front", "back", "both") else "neither",
        manufacturer=header.get("manufacturer", ""),
        nfrc_id=int(_first(header, "nfrc id", 0)) or None,
        source=str(path),
    )
    if table.shape[1] == 4 or not np.any(table[:, 2::2]):
        return pane
    return replace(pane, diffuse=Optics(*_columns(table, diffuse=True)))


def _columns(
    table: Float[np.ndarray, "row column"], *, diffuse: bool
) -> list[Float[np.ndarray, " row"]]:
    # Nine columns: wavelength, then direct and diffuse Tf, Tb, Rf and Rb in turn
    if table.shape[1] == 4:
        return [table[:, column] for column in (1, 1, 2, 3)]
    return [table[:, column + diffuse] for column in (1, 3, 5, 7)]


def _numbers(text: str) -> tuple[float, ...]:
    return tuple(float(word) for word in _NUMBER.findall(text))


def _first(header: dict[str, str], key: str, default: float) -> float:
    found = _numbers(header.get(key, "")) or (default,)
    finite(found[0], key)
    return found[0]
