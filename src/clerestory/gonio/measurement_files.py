"""Reader of goniophotometer files of all supported formats.

Each module in `clerestory.gonio.formats` reads one format. The format of a file is
recognized from the first bytes of the file.
"""

import codecs
import importlib
import pkgutil
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from types import MappingProxyType
from typing import get_args

from clerestory.bsdf.scattering_function import FUNCTIONS, Function
from clerestory.checks import one_of, require
from clerestory.errors import InputError, located
from clerestory.files import read_bytes
from clerestory.gonio import formats
from clerestory.gonio.formats.file_format import (
    Facing,
    FileFormat,
    FileHead,
    ReadOptions,
)
from clerestory.gonio.scattering_measurement import Measurement, merge_scans

# Number of bytes at the start of a file from which its format is recognized.
_HEAD = 4096


def _registry() -> Mapping[str, FileFormat]:
    # Find all formats in the package
    modules = (
        importlib.import_module(f"{formats.__name__}.{module.name}")
        for module in pkgutil.iter_modules(formats.__path__)
    )
    found = (getattr(module, "FORMAT", None) for module in modules)
    return MappingProxyType({f.name: f for f in found if isinstance(f, FileFormat)})


FORMATS = _registry()


def read_measurement(
    *paths: str | Path,
    form: str | None = None,
    function: Function | None = None,
    facing: Facing = "room",
    blank: Path | None = None,
    merge: bool = False,
) -> tuple[Measurement, ...]:
    """Read the measurements in goniophotometer files of one sample.

    Parameters
    ----------
    form : name of the format; default: recognized from the first file
    function : measured scattering function, for formats that do not state it
    facing : side to which the normal of the sample points, for pab-opto files
    blank : file of readings without a sample, for RT-300S workbooks
    merge : join scans with equal incident directions instead of raising an error

    Returns
    -------
    One measurement per scattering function and channel.

    Raises
    ------
    InputError : a file is damaged, or its format is unknown
    """
    one_of(function, "scattering function", choices=(None, *FUNCTIONS))
    one_of(facing, "facing side", choices=get_args(Facing))
    files = [Path(path) for path in paths]
    require(files, "no goniophotometer file; one or more expected")
    if form is not None:
        one_of(form, "goniophotometer format", choices=FORMATS)
    kind = _recognized_format(files[0]) if form is None else FORMATS[form]
    options = ReadOptions(function, facing, blank)
    groups: dict[tuple[str, str], list[Measurement]] = {}
    for file in files:
        with located(file=file):
            for part in kind.read(file, options):
                groups.setdefault((part.function, part.channel), []).append(part)
    return tuple(_joined(parts, merge) for parts in groups.values())


def _recognized_format(path: Path) -> FileFormat:
    # Recognize the format of a file from its first bytes
    data = read_bytes(path)[:_HEAD].removeprefix(codecs.BOM_UTF8)
    text = "" if b"\0" in data else data.decode("latin-1").lower()
    lines = (line.strip() for line in text.splitlines())
    head = FileHead(data, tuple(line for line in lines if line))
    for kind in FORMATS.values():
        if kind.recognizes(head):
            return kind
    known = ", ".join(FORMATS)
    message = f"not a goniophotometer file of a known format; one of {known} expected"
    raise InputError(message, file=path)


def _joined(parts: Sequence[Measurement], merge: bool) -> Measurement:
    # Join the measurements of one function and channel in several files
    scans = (scan for part in parts for scan in part.scans)
    claims = {part.claimed for part in parts}
    return replace(
        parts[0],
        scans=merge_scans(scans) if merge else tuple(scans),
        name=next((part.name for part in parts if part.name), ""),
        claimed=claims.pop() if len(claims) == 1 else None,
    )
