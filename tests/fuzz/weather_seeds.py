"""Weather files."""

import importlib.resources
from collections.abc import Callable
from pathlib import Path

from reader import Reader

from clerestory.sky.weather import Site
from sample_files import ROOF, STATION


def _epw() -> str:
    head = (
        "LOCATION,Testville,-,DEU,made,000000,50.0,8.5,1.0,110.0\n"
        "DESIGN CONDITIONS,0\nTYPICAL/EXTREME PERIODS,0\nGROUND TEMPERATURES,0\n"
        "HOLIDAYS/DAYLIGHT SAVINGS,No,0,0,0\nCOMMENTS 1,made\nCOMMENTS 2,\n"
        "DATA PERIODS,1,1,Data,Sunday, 3/21, 3/21\n"
    )
    rows = [
        f"1999,3,21,{hour},60,?9,9.0,4.5,70,101000,0,0,300,250,300,120,0,0,0,0"
        for hour in range(1, 25)
    ]
    return head + "\n".join(rows) + "\n"


WEA = (
    "place Testville_DEU\nlatitude 50.0\nlongitude -8.5\ntime_zone -15\n"
    "site_elevation 110\nweather_data_file_units 1\n3 21 11.5 300 120\n"
    "3 21 12.5 310 121\n"
)
TMY3 = (
    '722000,"TESTVILLE",NC,-5.0,36.100,-79.950,273\n'
    "Date (MM/DD/YYYY),Time (HH:MM),DNI (W/m^2),DHI (W/m^2),Dew-point (C)\n"
    "03/21/1999,01:00,0,0,4.0\n03/21/1999,02:00,0,0,4.0\n03/21/1999,12:00,500,100,4\n"
)


def _surfrad() -> str:
    rows = []
    for minute in range(5):
        numbers = [2016, 160, 6, 8, 18, minute, 18.0, 30.5, 900.0, 0]
        numbers += [200.0, 0, 800.0, 0, 100.0, 0, *([300.0, 0] * 16)]
        rows.append(" ".join(map(str, numbers)))
    return (
        " San Luis Valley\n   37.70 105.92 2317 m version 1\n" + "\n".join(rows) + "\n"
    )


def _through_station(function: Callable[..., object], path: Path) -> object:
    # The data file is damaged, the station file that names it is sound
    return function(path.with_name("station.toml"))


SRML = "94255\t2018\t1000\t0\t2010\t0\n" + "".join(
    f"1\t{minute}\t120.5\t12\t300\t12\n" for minute in range(1, 6)
)


def _tmy2(_: Path) -> list[bytes]:
    # The start of a year, which pvlib brings along
    whole = importlib.resources.files("pvlib") / "data" / "12839.tm2"
    return [b"".join(whole.read_bytes().splitlines(keepends=True)[:25])]


def _eugene(function: Callable[..., object], path: Path) -> object:
    return function(path, site=Site(44.05, -123.07, -8.0, 150.0, "Eugene"))


_ANY = "sky.weather_formats:read_weather"
READERS = {
    "epw": Reader(_ANY, "y.epw", (_epw(),)),
    "wea": Reader(_ANY, "y.wea", (WEA,)),
    "tmy2": Reader(_ANY, "y.tm2", make=_tmy2),
    "tmy3": Reader(_ANY, "y.csv", (TMY3,)),
    "surfrad": Reader(_ANY, "y.dat", (_surfrad(),)),
    "srml": Reader("sky.radiation_networks:read_srml", "y.txt", (SRML,), use=_eugene),
    "station": Reader(_ANY, "s.toml", (STATION,), beside={"roof.csv": ROOF}),
    "station data": Reader(
        _ANY,
        "roof.csv",
        (ROOF,),
        beside={"station.toml": STATION},
        use=_through_station,
    ),
}
