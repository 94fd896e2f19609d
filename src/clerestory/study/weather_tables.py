"""Tables of the study file on weather, sky and hours."""

from typing import Annotated, Literal, Self

from pydantic import Field, model_validator

from clerestory.documents import Table
from clerestory.metrics.en17037 import FIRST_DAY, LAST_DAY
from clerestory.sky.daylight_spectra import SkyColour, SunColour
from clerestory.sky.solar_position import SunFormula
from clerestory.sky.station_file import MeasuredTable, SiteTable
from clerestory.study.config_tables import MOMENT, require_one_of, require_rule
from clerestory.study.file_fields import InputFile

Moment = Annotated[str, Field(pattern=MOMENT)]
MonthDay = Annotated[str, Field(pattern=r"^(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])$")]


class HoursTable(Table):
    """Range of hours of the day, in local standard time."""

    from_hour: float = Field(0.0, ge=0, le=24)
    to_hour: float = Field(24.0, ge=0, le=24)

    @model_validator(mode="after")
    def _forwards(self) -> Self:
        require_rule(
            self.from_hour < self.to_hour,
            '"from_hour" is not before "to_hour"; a smaller "from_hour" expected',
        )
        return self


class ClearSkyTable(SiteTable):
    """Year of clear skies, in place of a weather file."""

    turbidity: float = Field(3.0, ge=1, le=10)
    step_minutes: int = Field(60, ge=1, le=60)

    @model_validator(mode="after")
    def _whole_hours(self) -> "ClearSkyTable":
        minutes = self.step_minutes
        require_rule(
            60 % minutes == 0,
            f'"step_minutes" is {minutes}; a divisor of 60 expected',
        )
        return self


class WeatherTable(HoursTable):
    """Weather file or clear skies, and selection of the simulated time steps."""

    file: InputFile | None = Field(
        None,
        description="a weather file (.epw, .wea, TMY3 .csv) or a station file (.toml)",
    )
    clear_sky: ClearSkyTable | None = Field(
        None, description="a table [weather.clear_sky]"
    )
    measured: MeasuredTable | None = Field(
        None, description="a table [weather.measured]"
    )
    first_day: MonthDay | None = Field(
        None, alias="from", description='a day of the year as "MM-DD"'
    )
    last_day: MonthDay | None = Field(
        None, alias="to", description='a day of the year as "MM-DD"'
    )
    to_hour: float = Field(24.0, ge=0, le=24)
    every: int = Field(1, ge=1, le=1440)
    moments: list[Moment] = Field(
        default_factory=list, description='a list of moments as "09-21T12:00"'
    )

    @model_validator(mode="after")
    def _one_source(self) -> "WeatherTable":
        require_one_of({'"file"': self.file, '"clear_sky"': self.clear_sky})
        require_rule(
            self.measured is None or self.file is not None,
            '"measured" without "file"; the file to read expected',
        )
        return self


class DaylightTable(Table):
    """Spectra of sky and sun, with bands other than RGB."""

    sky: SkyColour = "diakite"
    sun: SunColour = "spectrl2"
    aerosol_optical_depth: float = Field(0.1, ge=0, le=5)
    ozone_cm: float = Field(0.3, ge=0, le=1)
    sky_file: InputFile | None = Field(
        None, description="a file of measured spectra of the sky (.csv)"
    )
    sun_file: InputFile | None = Field(
        None, description="a file of measured spectra of the sun (.csv)"
    )


class SkyTable(Table):
    """Sky subdivision, ground reflectance, orientation of the scene, and spectra."""

    subdivision: Literal[1, 2, 3, 4, 5, 6] = 4
    ground_reflectance: float = Field(0.2, ge=0, le=1)
    rotation_deg: float = Field(0.0, ge=-360, le=360)
    sun_formula: SunFormula = "spa"
    daylight: DaylightTable = Field(default_factory=DaylightTable)


class ScheduleTable(HoursTable):
    """Occupied hours of the day, in local standard time."""

    from_hour: float = Field(8.0, ge=0, le=24)
    to_hour: float = Field(18.0, ge=0, le=24)


class SunlightTable(Table):
    """Exposure to sunlight according to EN 17037, on one day."""

    day: MonthDay = LAST_DAY
    lowest_sun_deg: float = Field(10.0, ge=0, le=45)
    floor: float = 0.0
    depth: float = Field(0.0, ge=0, le=5)
    file: InputFile | None = Field(
        None, description="a Radiance file of openings whose front faces the room"
    )

    @model_validator(mode="after")
    def _between_february_and_march(self) -> "SunlightTable":
        require_rule(
            FIRST_DAY <= self.day <= LAST_DAY,
            f'"day" is "{self.day}"; a day from "{FIRST_DAY}" to "{LAST_DAY}" expected',
        )
        return self
