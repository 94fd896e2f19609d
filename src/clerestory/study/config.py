"""The study file: what to simulate, in TOML.

Each table of the file is a class here; the description of a key is what messages
expect of it. `docs/study-file.md` explains them all.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any, Literal

from pydantic import (
    BaseModel,
    BeforeValidator,
    ConfigDict,
    Field,
    PrivateAttr,
    ValidationError,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from clerestory.engine.device import Device
from clerestory.files import read_text
from clerestory.metrics.autonomy import TARGET_LUX
from clerestory.sky.station import MeasuredTable
from clerestory.study.complaint import input_error, parse_toml


def _input_file(value: Any, info: Any) -> Any:
    # Files are named relative to the study, and must be there; info is ValidationInfo
    if not isinstance(value, str) or not value:
        raise PydanticCustomError("file", "the name of a file in quotes")
    path: Path = (info.context or {}).get("folder", Path()) / value
    if not path.is_file():
        raise PydanticCustomError("file", "the name of a file that exists")
    return path


InputFile = Annotated[Path, BeforeValidator(_input_file)]
_MOMENT = r"^(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])T([01]\d|2[0-3]):[0-5]\d$"
MonthDay = Annotated[str, Field(pattern=r"^(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])$")]


class _Table(BaseModel):
    model_config = ConfigDict(
        extra="forbid", frozen=True, strict=True, allow_inf_nan=False
    )


class _Named(_Table):
    name: str = Field(
        "",
        pattern=r"^[\w .-]*$",
        description="letters, digits, spaces, dots and dashes",
    )
    file: InputFile

    @property
    def label(self) -> str:
        """Name, or else the stem of the file's name."""
        return self.name or self.file.stem


class SceneTable(_Table):
    """The room and what stands around it."""

    files: list[InputFile] = Field(
        min_length=1, description="a list of Radiance scene files"
    )


class WindowTable(_Named):
    """A window group: polygons that share one BSDF."""

    file: InputFile = Field(description="a Radiance file of window polygons")
    bsdf: InputFile = Field(description="a BSDF file (.xml)")
    sun_bsdf: InputFile | None = Field(
        None, description="a BSDF file (.xml), as fine as it is known"
    )
    peak: bool = Field(False, description="whether light that passes straight is sharp")


class SensorsTable(_Named):
    """A grid of sensors."""

    file: InputFile = Field(description="a file of sensors, x y z dx dy dz a line")


class WeatherTable(_Table):
    """The weather, and the part of the year to simulate."""

    file: InputFile = Field(
        description="a weather file (.epw, .wea, TMY3 .csv) or a station file (.toml)"
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


class SkyTable(_Table):
    """How finely the sky is cut, the ground, and where north is."""

    subdivision: Literal[1, 2, 3, 4, 5, 6] = 4
    ground_reflectance: float = Field(0.2, ge=0, le=1)
    rotation_deg: float = Field(0.0, ge=-360, le=360)


class ViewTable(_Named):
    """A camera: glare at every step, and pictures of chosen moments."""

    file: InputFile = Field(description="a Radiance view file")
    resolution: int = Field(200, ge=8, le=4096)
    samples: int = Field(256, ge=1, le=1 << 20)
    pictures: list[Annotated[str, Field(pattern=_MOMENT)]] = Field(
        default_factory=list, description='a list of moments as "09-21T12:00"'
    )


class SunTable(_Table):
    """The direct sun of the five-phase method."""

    places: Literal["exact", "patches"] = "exact"
    tolerance_deg: float = Field(0.25, ge=0, le=5)
    samples: int = Field(64, ge=1, le=1 << 16)
    picture_samples: int = Field(16, ge=1, le=1 << 12)


class TraceTable(_Table):
    """How long to trace; `relative_error` is 0.01 when neither goal is given."""

    relative_error: float | None = Field(None, gt=0, lt=1)
    samples: int | None = Field(None, ge=1)
    bounces: int | None = Field(None, ge=0)
    seed: int = Field(1, ge=0, lt=2**32)
    device: Device = "auto"

    @model_validator(mode="after")
    def _one_goal(self) -> "TraceTable":
        if self.samples is not None and self.relative_error is not None:
            raise PydanticCustomError(
                "rule", 'both "samples" and "relative_error"; one of them expected'
            )
        return self

    def goal(self) -> dict[str, int | float]:
        """Return the goal as a keyword argument of the tracing functions.

        >>> TraceTable().goal(), TraceTable(samples=64).goal()
        ({'relative_error': 0.01}, {'samples': 64})
        """
        if self.samples is not None:
            return {"samples": self.samples}
        return {"relative_error": self.relative_error or 0.01}


class ScheduleTable(_Table):
    """The hours of the day that count, in local standard time."""

    from_hour: float = Field(8.0, ge=0, le=24)
    to_hour: float = Field(18.0, ge=0, le=24)

    @model_validator(mode="after")
    def _forwards(self) -> "ScheduleTable":
        if self.from_hour >= self.to_hour:
            raise PydanticCustomError(
                "rule", '"from_hour" is not before "to_hour"; the earlier one expected'
            )
        return self


class MetricsTable(_Table):
    """What the metrics ask for."""

    target_lux: float = Field(TARGET_LUX, gt=0)


class OutputTable(_Table):
    """Files written beside results.nc and run.json."""

    csv: bool = True
    ill: bool = False


class Study(_Table):
    """A whole run; the paths in it are resolved against its folder."""

    _folder: Path = PrivateAttr(Path())

    title: str = ""
    method: Literal["2-phase", "3-phase", "5-phase"] = Field(
        description='"2-phase", "3-phase" or "5-phase"'
    )
    scene: SceneTable = Field(description="a table [scene]")
    window: list[WindowTable] = Field(default_factory=list)
    sensors: list[SensorsTable] = Field(
        min_length=1, description="at least one table [[sensors]]"
    )
    view: list[ViewTable] = Field(default_factory=list)
    weather: WeatherTable = Field(description="a table [weather]")
    sky: SkyTable = SkyTable()
    sun: SunTable = SunTable()
    trace: TraceTable = TraceTable()
    schedule: ScheduleTable = ScheduleTable()
    metrics: MetricsTable = MetricsTable()
    output: OutputTable = OutputTable()

    @field_validator("window", "sensors", "view")
    @classmethod
    def _distinct(cls, tables: Sequence[_Named]) -> Sequence[_Named]:
        labels = [table.label for table in tables]
        twice = next((name for name in labels if labels.count(name) > 1), None)
        if twice is not None:
            raise PydanticCustomError(
                "rule",
                'two are named "{twice}"; different names expected',
                {"twice": twice},
            )
        return tables

    @model_validator(mode="after")
    def _windows_for_the_method(self) -> "Study":
        if self.method != "2-phase" and not self.window:
            raise PydanticCustomError(
                "rule",
                'method "{method}" without a window; a table [[window]] expected',
                {"method": self.method},
            )
        if self.method == "2-phase" and self.view:
            raise PydanticCustomError(
                "rule",
                'method "2-phase" makes no pictures; no table [[view]] expected',
            )
        if self.method == "2-phase" and self.window:
            raise PydanticCustomError(
                "rule",
                'method "2-phase" sees the sky through the glass of the scene;'
                " no table [[window]] expected",
            )
        return self

    def model_post_init(self, context: Any) -> None:
        """Remember the folder that the study file stands in."""
        self._folder = (context or {}).get("folder", Path())

    def with_trace(
        self, *, seed: int | None = None, device: Device | None = None
    ) -> "Study":
        """Return the study with another seed or device, where one is given."""
        given = {"seed": seed, "device": device}
        change = {key: value for key, value in given.items() if value is not None}
        trace = self.trace.model_copy(update=change)
        return self.model_copy(update={"trace": trace})

    def facts(self) -> dict[str, Any]:
        """Return every key with its value, files relative to the study."""

        def plain(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: plain(item) for key, item in value.items()}
            if isinstance(value, list):
                return [plain(item) for item in value]
            if isinstance(value, Path):
                inside = value.is_relative_to(self._folder)
                return (value.relative_to(self._folder) if inside else value).as_posix()
            return value

        return {
            key: plain(item) for key, item in self.model_dump(by_alias=True).items()
        }

    def to_json(self) -> str:
        """Return the facts as JSON."""
        return json.dumps(self.facts(), sort_keys=True)


def read_study(path: str | Path) -> Study:
    """Return the study in a TOML file; its paths are relative to that file.

    Raises
    ------
    InputError : the file cannot be read, is not TOML, or a key is missing,
        unknown or wrong; with the line and the valid choices
    """
    path = Path(path)
    text = read_text(path)
    tables = parse_toml(text, file=path)
    try:
        study = Study.model_validate(tables, context={"folder": path.parent})
    except ValidationError as error:
        raise input_error(error, model=Study, text=text, file=path) from error
    return study.model_copy(update={"title": study.title or path.stem})
