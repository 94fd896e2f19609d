"""Weather files of every kind, told apart by their content."""

import importlib
from collections.abc import Callable
from pathlib import Path

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.sky.epw import read_epw
from clerestory.sky.radiation_networks import looks_like_surfrad, read_surfrad
from clerestory.sky.tmy2 import looks_like_tmy2, read_tmy2
from clerestory.sky.tmy3 import read_tmy3
from clerestory.sky.wea import read_wea
from clerestory.sky.weather import Weather


def read_weather(path: str | Path) -> Weather:
    """Return the weather in an EPW, WEA, TMY2, TMY3, SURFRAD or station file.

    The first lines tell which it is; the suffix does not matter, but for station
    files (.toml), which describe files of measurements. Dates of typical years are
    written in the year 2023 (2024 where the file has a 29 February).

    Raises
    ------
    InputError : the file is none of these, or one of them with a fault in it
    """
    reader = _reader(path)
    try:
        return reader(path)
    except InputError as error:
        # Faults that only show in the whole are the file's too
        if error.file is not None:
            raise
        raise InputError(error.message, file=path) from error


def _reader(path: str | Path) -> Callable[[str | Path], Weather]:
    if Path(path).suffix.lower() == ".toml":
        # Tables of settings take long to load, which only station files should wait for
        station = importlib.import_module("clerestory.sky.station_file")
        reader: Callable[[str | Path], Weather] = station.read_station
        return reader
    head = read_text(path)[:4000].splitlines()
    first = head[0].lstrip().lower() if head else ""
    if first.startswith("location,"):
        return read_epw
    if first.startswith("place"):
        return read_wea
    if len(head) > 1 and head[1].startswith("Date (MM/DD/YYYY)"):
        return read_tmy3
    if head and looks_like_tmy2(head[0]):
        return read_tmy2
    if looks_like_surfrad(head):
        return read_surfrad
    raise InputError(
        "unknown kind of weather file; EPW, WEA, TMY2, TMY3 or SURFRAD expected, or"
        " a station file (.toml) that says how measurements are read",
        file=path,
        line=1,
    )
