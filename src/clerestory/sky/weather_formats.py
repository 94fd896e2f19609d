"""List of weather file formats, which are recognised by the first lines of a file.

To add a format, write a module with a reader and add a line to `FORMATS`.
"""

import importlib
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.sky.epw import read_epw
from clerestory.sky.radiation_networks import is_surfrad, read_surfrad
from clerestory.sky.tmy2 import is_tmy2_header, read_tmy2
from clerestory.sky.tmy3 import DATE, read_tmy3
from clerestory.sky.wea import read_wea
from clerestory.sky.weather import Weather

Reader = Callable[[str | Path], Weather]

# Number of characters at the start of a file by which the format is recognised
_HEAD = 4000


class WeatherFormat(NamedTuple):
    """Weather file format: name, test of the first lines of a file, and reader."""

    name: str
    recognises: Callable[[list[str]], bool]
    read: Reader


FORMATS = (
    WeatherFormat("EPW", lambda head: _begins(head, "location,"), read_epw),
    WeatherFormat("WEA", lambda head: _begins(head, "place"), read_wea),
    WeatherFormat("TMY2", lambda head: is_tmy2_header(head[0]), read_tmy2),
    WeatherFormat(
        "TMY3", lambda head: len(head) > 1 and head[1].startswith(DATE), read_tmy3
    ),
    WeatherFormat("SURFRAD", is_surfrad, read_surfrad),
)


def read_weather(path: str | Path) -> Weather:
    """Return the weather in an EPW, WEA, TMY2, TMY3, SURFRAD or station file.

    The format is recognised by the first lines, not by the suffix, except for station
    files (.toml), which describe measurement files. Dates of typical years are in 2023,
    or in 2024 if the file includes 29 February.

    Raises
    ------
    InputError : the format is unknown, or the file has an error
    """
    with located(file=path):
        return _reader(path)(path)


def _reader(path: str | Path) -> Reader:
    if Path(path).suffix.lower() == ".toml":
        # Imported here, since Pydantic loads slowly
        station = importlib.import_module("clerestory.sky.station_file")
        reader: Reader = station.read_station
        return reader
    head = read_text(path)[:_HEAD].splitlines() or [""]
    for one in FORMATS:
        if one.recognises(head):
            return one.read
    *names, last = (one.name for one in FORMATS)
    raise InputError(
        f"unknown weather file format; {', '.join(names)} or {last} expected, or a"
        " station file (.toml) that describes a measurement file",
        line=1,
    )


def _begins(head: list[str], word: str) -> bool:
    return head[0].lstrip().lower().startswith(word)
