"""Schema of the study file (TOML); see `docs/study-file.md`.

Each TOML table is a class. If a value is wrong, the error message quotes the
`description` of its field as the expected value.
"""

import json
from pathlib import Path
from typing import Annotated, Any

from pydantic import BeforeValidator, Field, PrivateAttr, model_validator
from pydantic_core import PydanticCustomError

from clerestory.bands import RGB
from clerestory.checks import require
from clerestory.documents import Table, toml_tables, validated
from clerestory.engine.device import Device
from clerestory.escaping import printable
from clerestory.files import read_text
from clerestory.phases.matrix_equation import Term
from clerestory.phases.methods import METHODS, MethodName
from clerestory.spectral.band_sets import band_set, gives
from clerestory.study import config_tables as tables
from clerestory.study import weather_tables
from clerestory.study.compliance_tables import ComplianceTable, SpaceTable
from clerestory.study.config_tables import Distinct, require_rule
from clerestory.study.energy_tables import EnergyTable
from clerestory.study.lighting_tables import LightingTable, LuminaireTable
from clerestory.study.optimise_tables import OptimiseTable
from clerestory.study.report_tables import ReportTable
from clerestory.study.sensitivity_table import SensitivityTable
from clerestory.study.table_names import require_names
from clerestory.study.uncertainty_tables import UncertaintyTable
from clerestory.study.view_grid_tables import ViewGridTable
from clerestory.study.window_tables import WindowTable
from clerestory.toml_lines import key_lines

# Tables of variants, see `study.variants`
LISTED, SWEPT = "variant", "sweep"

_METHODS = " or".join(", ".join(f'"{name}"' for name in METHODS).rsplit(",", 1))


def _methods(value: Any) -> Any:
    # Accept one method, or a list of distinct methods to compare
    chosen = value if isinstance(value, list) else [value]
    known = all(isinstance(m, str) and m in METHODS for m in chosen)
    if not (chosen and known and len(set(chosen)) == len(chosen)):
        expected = _METHODS + (", each once," if isinstance(value, list) else "")
        raise PydanticCustomError("choice", expected)
    return chosen


class Study(Table):
    """Content of a study file; its paths are relative to the folder of the file."""

    _folder: Path = PrivateAttr(Path())

    title: Annotated[
        str, Field(pattern=r"^[^\x00-\x1f\x7f]*$", description="one line of text")
    ] = ""
    methods: Annotated[list[MethodName], BeforeValidator(_methods)] = Field(
        alias="method", description=_METHODS
    )
    scene: tables.SceneTable = Field(description="a table [scene]")
    window: Annotated[list[WindowTable], Distinct] = Field([])
    sensors: Annotated[list[tables.SensorsTable], Distinct] = Field(
        min_length=1, description="at least one table [[sensors]]"
    )
    view: Annotated[list[tables.ViewTable], Distinct] = Field([])
    view_grid: Annotated[list[ViewGridTable], Distinct] = Field([])
    luminaire: Annotated[list[LuminaireTable], Distinct] = Field([])
    lighting: Annotated[list[LightingTable], Distinct] = Field([])
    weather: weather_tables.WeatherTable = Field(description="a table [weather]")
    sky: weather_tables.SkyTable = weather_tables.SkyTable()
    sun: Annotated[tables.SunTable, BeforeValidator(tables.sun_places)] = (
        tables.SunTable()
    )
    trace: tables.TraceTable = tables.TraceTable()
    schedule: weather_tables.ScheduleTable = weather_tables.ScheduleTable()
    metrics: tables.MetricsTable = tables.MetricsTable()
    sunlight: weather_tables.SunlightTable | None = Field(
        None, description="a table [sunlight]"
    )
    space: Annotated[list[SpaceTable], Distinct] = Field([])
    compliance: ComplianceTable | None = Field(None, description="a table [compliance]")
    energy: EnergyTable | None = Field(None, description="a table [energy]")
    sensitivity: SensitivityTable | None = Field(
        None, description="a table [sensitivity]"
    )
    uncertainty: UncertaintyTable | None = Field(
        None, description="a table [uncertainty]"
    )
    optimise: OptimiseTable | None = Field(None, description="a table [optimise]")
    report: ReportTable = ReportTable()
    output: tables.OutputTable = tables.OutputTable()

    @model_validator(mode="after")
    def _windows_for_the_method(self) -> "Study":
        for method in self.methods:
            require_rule(
                self.window or not METHODS[method].windows,
                f'method "{method}" without a window; a table [[window]] expected',
            )
        if self.methods == ["2-phase"]:
            self._require_glazing()
        return self

    def _require_glazing(self) -> None:
        # Two phases: no pictures; view grids where the glazing is part of the scene
        require_rule(
            not self.view,
            'method "2-phase" computes no images; no table [[view]] expected',
        )
        require_rule(
            not (self.view_grid and self.window),
            '[[view_grid]] with method "2-phase" and a table [[window]]; glazing in the'
            ' scene, or method = "5-phase", expected',
        )
        require_rule(
            not self.view_grid or self.sun.places == "exact",
            '[[view_grid]] with method "2-phase" and places = "patches" of the sun;'
            ' "exact" expected',
        )

    @model_validator(mode="after")
    def _ports_for_the_method(self) -> "Study":
        ports = any(window.ports for window in self.window)
        for method in self.methods:
            facade = METHODS[method].facade
            require_rule(
                facade or not ports,
                f'"ports" with method "{method}"; "4-phase" or "6-phase" expected',
            )
            require_rule(
                ports or not facade,
                f'method "{method}" without ports; the key "ports" of a table'
                " [[window]] expected",
            )
        return self

    @model_validator(mode="after")
    def _sun_of_the_method(self) -> "Study":
        exact = "places" in self.sun.model_fields_set and self.sun.places == "exact"
        other = "6-phase" if METHODS[self.method].facade else "5-phase"
        require_rule(
            not exact or any(METHODS[m].correction != "never" for m in self.methods),
            f'method "{self.method}" has no exact sun; places = "patches" or method ='
            f' "{other}" expected',
        )
        require_rule(
            not self.sunlight or self.window or self.sunlight.file,
            "[sunlight] without a window; a file of openings expected",
        )
        return self

    @model_validator(mode="after")
    def _names_that_exist(self) -> "Study":
        require_names(self)
        return self

    @model_validator(mode="after")
    def _states_for_the_output(self) -> "Study":
        several = any(len(window.states()) > 1 for window in self.window)
        windows = all(METHODS[method].windows for method in self.methods)
        require_rule(
            not self.output.by_state or (several and windows),
            '"by_state" without a window that has several states; tables'
            " [[window.state]], and a method with windows, expected",
        )
        return self

    @model_validator(mode="after")
    def _bands_for_the_output(self) -> "Study":
        bands = band_set(self.scene.bands)
        require_rule(
            not self.output.spectral or gives(bands, "melanopic"),
            f'"spectral" with the bands "{self.scene.bands}"; bands such as'
            ' "melanopic+photopic" or "20" expected',
        )
        for lamp in self.luminaire:
            require_rule(
                lamp.spectrum is None or bands != RGB,
                f'luminaire "{lamp.label}" has a spectrum, with the bands "RGB"; bands'
                ' such as "melanopic+photopic" or "20" expected',
            )
        for window in self.window:
            require_rule(
                not (window.control and window.control.melanopic)
                or gives(bands, "melanopic"),
                f'a control rule of window "{window.label}" depends on melanopic light,'
                f' with the bands "{self.scene.bands}"; bands such as'
                ' "melanopic+photopic" or "20" expected',
            )
        return self

    @property
    def method(self) -> MethodName:
        """Phase method; the first one if several are compared."""
        return self.methods[0]

    @property
    def corrected(self) -> bool:
        """Whether the direct-sun correction is applied."""
        choice = METHODS[self.method].correction
        return choice == "always" or (choice == "choice" and self.sun.places == "exact")

    @property
    def terms(self) -> tuple[Term, ...]:
        """Terms of the matrix equation of the phase method."""
        return METHODS[self.method].terms(corrected=self.corrected)

    @property
    def folder(self) -> Path:
        """Folder of the study file."""
        return self._folder

    def assesses(self, standard: str) -> bool:
        """Whether a page on a standard is requested."""
        return self.compliance is not None and standard in self.compliance.standards

    def with_method(self, method: MethodName) -> "Study":
        """Return a copy of the study with one phase method.

        Two phases have no views, and view grids only in scenes with glazing.
        """
        seen = {"view": self.view, "view_grid": self.view_grid}
        if method == "2-phase":
            seen = {"view": [], "view_grid": [] if self.window else self.view_grid}
        return self.model_copy(update={"methods": [method], **seen})

    def model_post_init(self, context: Any) -> None:
        """Store the folder of the study file."""
        self._folder = (context or {}).get("folder", Path())

    def with_trace(
        self,
        *,
        seed: int | None = None,
        device: Device | None = None,
        cluster: str | None = None,
    ) -> "Study":
        """Return a copy with another seed, compute device or cluster, unless None."""
        given = {"seed": seed, "device": device, "cluster": cluster}
        change = {key: value for key, value in given.items() if value is not None}
        return self.model_copy(update={"trace": self.trace.model_copy(update=change)})

    def facts(self) -> dict[str, Any]:
        """Return all keys and values of the study, with paths relative to `folder`."""

        def plain(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: plain(item) for key, item in value.items()}
            if isinstance(value, list):
                return [plain(item) for item in value]
            return self.relative(value) if isinstance(value, Path) else value

        facts = {key: plain(v) for key, v in self.model_dump(by_alias=True).items()}
        if len(self.methods) == 1:
            facts["method"] = self.method
        return facts

    def relative(self, path: Path) -> str:
        """Return a path relative to `folder`, if it is inside."""
        inside = path.is_relative_to(self._folder)
        return (path.relative_to(self._folder) if inside else path).as_posix()

    def to_json(self) -> str:
        """Return all keys and values of the study file as JSON."""
        return json.dumps(self.facts(), sort_keys=True)


def read_study(path: str | Path) -> Study:
    """Read a study from a TOML file, whose paths are relative to its folder.

    Raises
    ------
    InputError : the file cannot be read, is not TOML, or a key is missing,
        unknown or wrong; the message has the line and the valid choices. A study with
        variants is read by `read_variants`
    """
    path = Path(path)
    text = read_text(path)
    tables, lines = toml_tables(text, file=path), key_lines(text)
    for key in (LISTED, SWEPT):
        message = f'has variants, the key "{key}"; a study for `read_variants` expected'
        require(key not in tables, message, file=path, line=lines.get((key,)))
    context = {"folder": path.parent}
    study = validated(tables, Study, file=path, context=context, lines=lines)
    return with_title(study, path)


def with_title(study: Study, path: Path) -> Study:
    """Return a study with a title, by default the stem of the name of its file."""
    return study.model_copy(update={"title": study.title or printable(path.stem)})
