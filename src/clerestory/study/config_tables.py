"""Tables of the study file, except for those in modules of their own.

Each TOML table is a class. If a value is wrong, the error message quotes the
`description` of its field as the expected value.
"""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import AfterValidator, BeforeValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from clerestory.bands import RGB
from clerestory.documents import Table
from clerestory.engine.device import Device
from clerestory.errors import InputError
from clerestory.escaping import printable
from clerestory.metrics.climate_based_metrics import TARGET_LUX
from clerestory.scene.scaling import METRES, Unit
from clerestory.spectral.band_sets import band_set
from clerestory.spectral.material_library import material_spectrum
from clerestory.study.file_fields import InputFile, file_or_name

MOMENT = r"^(0[1-9]|1[0-2])-(0[1-9]|[12]\d|3[01])T([01]\d|2[0-3]):[0-5]\d$"
EVERY = "every"


def require_rule(valid: object, message: str) -> None:
    """Raise a validation error with a message, unless `valid`."""
    if not valid:
        raise PydanticCustomError("rule", "{message}", {"message": message})


class Named(Table):
    """Table of the study file with an optional name."""

    name: str = Field(
        "",
        pattern=r"^[\w .-]*$",
        description="letters, digits, spaces, dots and dashes",
    )

    @property
    def label(self) -> str:
        """Name of the table."""
        return self.name


class NamedFile(Named):
    """Table with a file; without a name, the table is named after the file."""

    file: InputFile

    @property
    def label(self) -> str:
        """Name of the table, by default the stem of the file name."""
        return self.name or printable(self.file.stem)


Place = Annotated[list[float], Field(min_length=3, max_length=3)]


def _distinct(tables: Sequence[Named]) -> Sequence[Named]:
    labels = [table.label for table in tables]
    twice = [name for name in labels if labels.count(name) > 1]
    message = f'two tables have the name "{"".join(twice[:1])}"'
    require_rule(not twice, f"{message}; different names expected")
    return tables


# Check that all tables in a list have different names
Distinct = AfterValidator(_distinct)


def require_one_of(keys: Mapping[str, object]) -> None:
    """Raise a validation error unless exactly one of two keys is given."""
    given = sum(map(bool, keys.values()))
    words = "both {} and {}" if given else "neither {} nor {}"
    require_rule(given == 1, f"{words.format(*keys)}; one of them expected")


class SpectrumTable(Table):
    """Spectrum of a material, in place of its colour in the scene files."""

    material: str = Field(min_length=1, description="the name of a material")
    file: Annotated[Path, file_or_name(material_spectrum)] = Field(
        description="a file of wavelengths [nm] and values, or library:NAME"
    )


def _known_bands(name: str) -> str:
    try:
        band_set(name)
    except InputError as problem:
        raise PydanticCustomError(
            "rule", "{message}", {"message": str(problem)}
        ) from None
    return name


class SceneTable(Table):
    """Scene files of the room and its surroundings, and the bands of light."""

    files: list[InputFile] = Field(
        min_length=1, description="a list of Radiance scene files"
    )
    units: Unit = "metres"
    glazing: list[str] = Field(
        default_factory=list, description="a list of names of materials"
    )
    bands: Annotated[str, AfterValidator(_known_bands)] = "RGB"
    spectrum: list[SpectrumTable] = Field(
        default_factory=list, description="tables [[scene.spectrum]]"
    )

    @model_validator(mode="after")
    def _bands_suffice(self) -> Self:
        bands = band_set(self.bands)
        require_rule(
            bands.efficacy,
            f'the bands "{self.bands}" do not give illuminance; a set with photopic'
            " expected",
        )
        require_rule(
            bands != RGB or not self.spectrum,
            "spectra of materials with the bands RGB; bands such as"
            ' "melanopic+photopic" or "20" expected',
        )
        names = [table.material for table in self.spectrum]
        twice = [name for name in names if names.count(name) > 1]
        require_rule(
            not twice,
            f'two spectra of the material "{"".join(twice[:1])}"; one expected',
        )
        return self

    @property
    def metres(self) -> float:
        """Length of the unit of scenes, windows, sensors, views and places [m]."""
        return METRES[self.units]


class SensorsTable(NamedFile):
    """A grid of sensors."""

    file: InputFile = Field(description="a file of sensors, x y z dx dy dz a line")


def _pictures(value: Any) -> Any:
    # The word "every" selects all time steps
    if isinstance(value, str) and value != EVERY:
        raise PydanticCustomError("choice", '"every", or a list of moments')
    return [value] if isinstance(value, str) else value


class ViewTable(Named):
    """View for glare at every time step and for images at selected dates and times.

    It is that of a Radiance view file, or a fisheye view from a position.
    """

    file: InputFile | None = Field(None, description="a Radiance view file")
    position: Place | None = Field(None, description="a list [x, y, z]")
    direction: Place | None = Field(None, description="a list [x, y, z]")
    resolution: int = Field(200, ge=8, le=4096)
    samples: int = Field(64, ge=1, le=1 << 20)
    pictures: Annotated[
        list[Annotated[str, Field(pattern=f"^{EVERY}$|{MOMENT}")]],
        BeforeValidator(_pictures),
    ] = Field(
        default_factory=list,
        description='"every", or a list of moments as "09-21T12:00"',
    )

    @property
    def label(self) -> str:
        """Name of the view, by default the stem of the file name."""
        return self.name or printable(Path(self.file or "").stem)

    @model_validator(mode="after")
    def _file_or_position(self) -> Self:
        require_one_of({'"file"': self.file, '"position"': self.position})
        require_rule(
            bool(self.position) == bool(self.direction),
            '"position" or "direction" without the other; both expected',
        )
        require_rule(
            self.direction is None or any(self.direction),
            '"direction" is zero; the direction of view expected',
        )
        require_rule(
            self.file or self.name, '"position" without "name"; a name expected'
        )
        return self


def sun_places(value: Any) -> Any:
    """Return the table [sun] for the short form `sun = "exact"` or "patches"."""
    return {"places": value} if isinstance(value, str) else value


class SunTable(Table):
    """Sun positions and number of samples of the direct-sun correction."""

    places: Literal["exact", "patches"] = "exact"
    tolerance_deg: float = Field(0.25, ge=0, le=5)
    samples: int | None = Field(None, ge=1, le=1 << 20)
    picture_samples: int = Field(16, ge=1, le=1 << 12)


class TraceTable(Table):
    """Options of ray tracing; without `samples`, `relative_error` defaults to 0.01."""

    relative_error: float | None = Field(None, gt=0, lt=1)
    samples: int | None = Field(None, ge=1)
    bounces: int | None = Field(None, ge=0)
    seed: int = Field(1, ge=0, lt=2**32)
    device: Device = "auto"
    memory_gb: float = Field(4.0, ge=0)
    # Excluded from the results file, as results do not depend on the cluster
    cluster: str | None = Field(
        None, exclude=True, description="the address of a dask scheduler"
    )

    @model_validator(mode="after")
    def _one_goal(self) -> "TraceTable":
        require_rule(
            self.samples is None or self.relative_error is None,
            'both "samples" and "relative_error"; one of them expected',
        )
        return self


class MetricsTable(Table):
    """Target illuminance of the metrics [lux]."""

    target_lux: float = Field(TARGET_LUX, gt=0)


class OutputTable(Table):
    """Output files in addition to results.nc and run.json."""

    csv: bool = True
    ill: bool = False
    by_state: bool = False
    spectral: list[str] = Field(
        default_factory=list, description="a list of grids of eyes"
    )
