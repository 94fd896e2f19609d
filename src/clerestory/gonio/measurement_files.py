"""Read goniophotometer files of any known format."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal, get_args

from clerestory.bsdf.scattering_function import Function
from clerestory.errors import InputError
from clerestory.files import read_bytes
from clerestory.gonio.formats.astm import read_astm
from clerestory.gonio.formats.columns import read_columns
from clerestory.gonio.formats.fred import read_fred
from clerestory.gonio.formats.pabopto import Facing, read_pabopto
from clerestory.gonio.formats.rt300s import read_rt300s
from clerestory.gonio.formats.viavi import read_viavi
from clerestory.gonio.formats.zemax import read_zemax
from clerestory.gonio.scattering_measurement import Measurement, merge_scans

Format = Literal["pabopto", "viavi", "rt300s", "zemax", "fred", "astm", "columns"]
FORMATS: tuple[Format, ...] = get_args(Format)

# Bytes at the start of a file in which its format shows.
_HEAD = 4096

# How files of Excel 97 begin.
_WORKBOOK = b"\xd0\xcf\x11\xe0"


def read_measurement(
    *paths: str | Path,
    form: Format | None = None,
    function: Function | None = None,
    facing: Facing = "room",
    blank: Path | None = None,
    merge: bool = False,
) -> tuple[Measurement, ...]:
    """Return the measurements in goniophotometer files of one sample.

    Parameters
    ----------
    form : of the files; None to tell from the first
    function : which light was measured, where the format does not say
    facing : where the normal of the sample looks, for pab-opto's files
    blank : readings without a sample, for workbooks of the RT-300S
    merge : join scans of the same incident direction instead of refusing them

    Returns
    -------
    One measurement per function and channel.

    Raises
    ------
    InputError : a file is not of a known format, or damaged
    """
    files = [Path(path) for path in paths]
    if not files:
        raise InputError("no goniophotometer file; one or more expected")
    kind = form or _format(files[0])
    if merge and kind == "pabopto":
        return tuple(_merged(files, facing))
    given = {} if function is None else {"function": function}
    if kind == "pabopto":
        return read_pabopto(files, facing=facing)
    if kind == "zemax":
        side = "back" if (function or "").endswith("back") else "front"
        return read_zemax(files, side=side)
    if kind == "rt300s":
        return read_rt300s(files, blank=blank, **given)
    if kind == "columns":
        return read_columns(files, function=function)
    readers = {"viavi": read_viavi, "fred": read_fred, "astm": read_astm}
    return readers[kind](files, **given)


def _merged(files: Sequence[Path], facing: Facing) -> list[Measurement]:
    # Every file alone, then those of one function and channel together
    single = [part for file in files for part in read_pabopto([file], facing=facing)]
    keys = dict.fromkeys((part.function, part.channel) for part in single)
    merged = []
    for key in keys:
        parts = [part for part in single if (part.function, part.channel) == key]
        scans = merge_scans(scan for part in parts for scan in part.scans)
        merged.append(replace(parts[-1], scans=scans))
    return merged


def _format(path: Path) -> Format:
    head = read_bytes(path)[:_HEAD]
    if head.startswith(_WORKBOOK):
        return "rt300s"
    text = head.decode("latin-1").lower()
    lines = [line.strip() for line in text.splitlines() if line.strip()]
    if text.startswith("!!"):
        return "viavi"
    if lines and lines[0].startswith("type bsdf_data"):
        return "fred"
    if any(line.startswith("vars") for line in lines):
        return "astm"
    if any(line.startswith(("samplerotation", "angleofincidence")) for line in lines):
        return "zemax"
    if any(line.startswith("theta_i") for line in lines):
        return "columns"
    keys = ("#format", "#intheta", "#incident_angle", "#inphi", "#colorimetry")
    if any(line.replace("# ", "#").startswith(keys) for line in lines):
        return "pabopto"
    raise InputError(
        f"not a goniophotometer file; one of {', '.join(FORMATS)} expected", file=path
    )
