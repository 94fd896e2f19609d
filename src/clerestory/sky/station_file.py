"""Station files (.toml), which describe the site and columns of a measurement file.

    file = "roof.csv"
    stands_for = "end"

    [site]
    latitude_deg = 50.0
    longitude_deg = 8.5
    utc_offset_hours = 1

    [columns]
    time = "time"
    global_horizontal = "GHI"
    diffuse_horizontal = "DHI"

A station file is accepted wherever a weather file is expected.
"""

from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from clerestory.documents import Table, read_toml
from clerestory.errors import InputError
from clerestory.sky.csv_measurements import Columns, read_measured
from clerestory.sky.irradiance_decomposition import Decomposition
from clerestory.sky.radiation_networks import read_srml, read_surfrad
from clerestory.sky.time_steps import StandsFor
from clerestory.sky.weather import Site, Weather


def _as_list(value: Any) -> Any:
    return [value] if isinstance(value, str) else value


# List of names; a single name becomes a list of one
OneOrSeveral = Annotated[list[str], BeforeValidator(_as_list)]


class SiteTable(Table):
    """Table [site]: location of the measurement."""

    latitude_deg: float = Field(ge=-90, le=90, description="degrees, positive north")
    longitude_deg: float = Field(ge=-180, le=180, description="degrees, positive east")
    utc_offset_hours: float = Field(ge=-14, le=14, description="hours ahead of UTC")
    elevation: float = Field(0.0, ge=-500, le=9000)
    place: str = ""

    def site(self) -> Site:
        """Return the location as a `Site`."""
        return Site(**self.model_dump(include=set(SiteTable.model_fields)))


class ColumnsTable(Table):
    """Table [columns]: column name of each measured quantity."""

    time: OneOrSeveral = Field(min_length=1, description="the name of a column")
    global_horizontal: str | None = None
    diffuse_horizontal: str | None = None
    direct_normal: str | None = None
    global_illuminance: str | None = None
    diffuse_illuminance: str | None = None
    direct_illuminance: str | None = None
    dew_point: str | None = None

    def columns(self) -> Columns:
        """Return the column names for `read_measured`."""
        return Columns(tuple(self.time), **self.model_dump(exclude={"time"}))


class MeasuredTable(Table):
    """Description of a measurement file, with the arguments of `read_measured`.

    SURFRAD and SRML files have fixed columns, so they take no table [columns].
    """

    format: Literal["csv", "srml", "surfrad"] = "csv"
    site: SiteTable | None = Field(None, description="a table [site]")
    columns: ColumnsTable | None = Field(None, description="a table [columns]")
    time_format: str | None = None
    stands_for: StandsFor = "centre"
    clock: str | None = None
    separator: str = Field(",", min_length=1, max_length=1)
    skip_lines: int = Field(0, ge=0)
    decomposition: Decomposition = "erbs"

    @model_validator(mode="after")
    def _complete(self) -> "MeasuredTable":
        if self.site is None and self.format != "surfrad":
            raise PydanticCustomError("rule", "no site; a table [site] expected")
        if (self.columns is not None) != (self.format == "csv"):
            expected = "a table" if self.format == "csv" else "no table"
            raise PydanticCustomError(
                "rule",
                "format {name}; {expected} [columns] expected",
                {"name": self.format, "expected": expected},
            )
        return self


class _StationFile(MeasuredTable):
    file: str = Field(min_length=1)


def read_with(path: str | Path, how: MeasuredTable) -> Weather:
    """Return the weather in a measurement file; `how` describes the file."""
    if how.format == "surfrad":
        offset = None if how.site is None else how.site.utc_offset_hours
        return read_surfrad(path, utc_offset_hours=offset)
    if how.site is None:
        raise InputError("no site; a table [site] expected", file=path)
    site = how.site.site()
    if how.format == "srml":
        return read_srml(path, site=site, decomposition=how.decomposition)
    if how.columns is None:
        raise InputError("no columns; a table [columns] expected", file=path)
    settings = how.model_dump(exclude={"format", "site", "columns", "file"})
    return read_measured(path, columns=how.columns.columns(), site=site, **settings)


def read_station(path: str | Path) -> Weather:
    """Return the weather of a station file.

    The path of the measurement file is relative to the folder of the station file.
    """
    station = read_toml(path, _StationFile)
    return read_with(Path(path).parent / station.file, station)
