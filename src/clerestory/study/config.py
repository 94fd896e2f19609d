"""Schema of the study file (TOML).

Each table of the file is a class; error messages state the description of a key as
the expected value. See `docs/study-file.md`.
"""

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Annotated, Any

from pydantic import (
    BeforeValidator,
    Field,
    PrivateAttr,
    field_validator,
    model_validator,
)
from pydantic_core import PydanticCustomError

from clerestory.engine.device import Device
from clerestory.phases.matrix_equation import Term
from clerestory.phases.methods import METHODS, MethodName
from clerestory.study.config_tables import (
    MetricsTable,
    Named,
    OutputTable,
    SceneTable,
    ScheduleTable,
    SensorsTable,
    SkyTable,
    SunlightTable,
    SunTable,
    TraceTable,
    ViewTable,
    WeatherTable,
    rule_broken,
    sun_places,
)
from clerestory.study.lighting_tables import LightingTable, LuminaireTable
from clerestory.study.window_tables import WindowTable
from clerestory.toml_tables import Table, read_table

_METHODS = " or".join(", ".join(f'"{name}"' for name in METHODS).rsplit(",", 1))


def _methods(value: Any) -> Any:
    # One method, or a list of distinct methods to compare
    chosen = value if isinstance(value, list) else [value]
    known = all(isinstance(m, str) and m in METHODS for m in chosen)
    if not (chosen and known and len(set(chosen)) == len(chosen)):
        expected = _METHODS + (", each once," if isinstance(value, list) else "")
        raise PydanticCustomError("choice", expected)
    return chosen


class Study(Table):
    """Study, as described by a study file; paths are relative to its folder."""

    _folder: Path = PrivateAttr(Path())

    title: str = ""
    methods: Annotated[list[MethodName], BeforeValidator(_methods)] = Field(
        alias="method", description=_METHODS
    )
    scene: SceneTable = Field(description="a table [scene]")
    window: list[WindowTable] = Field(default_factory=list)
    sensors: list[SensorsTable] = Field(
        min_length=1, description="at least one table [[sensors]]"
    )
    view: list[ViewTable] = Field(default_factory=list)
    luminaire: list[LuminaireTable] = Field(default_factory=list)
    lighting: list[LightingTable] = Field(default_factory=list)
    weather: WeatherTable = Field(description="a table [weather]")
    sky: SkyTable = SkyTable()
    sun: Annotated[SunTable, BeforeValidator(sun_places)] = SunTable()
    trace: TraceTable = TraceTable()
    schedule: ScheduleTable = ScheduleTable()
    metrics: MetricsTable = MetricsTable()
    sunlight: SunlightTable | None = Field(None, description="a table [sunlight]")
    output: OutputTable = OutputTable()

    @field_validator("window", "sensors", "view", "luminaire", "lighting")
    @classmethod
    def _distinct(cls, tables: Sequence[Named]) -> Sequence[Named]:
        labels = [table.label for table in tables]
        twice = next((name for name in labels if labels.count(name) > 1), None)
        if twice is not None:
            raise rule_broken(
                'two are named "{twice}"; different names expected', twice=twice
            )
        return tables

    @model_validator(mode="after")
    def _windows_for_the_method(self) -> "Study":
        for method in self.methods:
            if METHODS[method].windows and not self.window:
                raise rule_broken(
                    'method "{method}" without a window; a table [[window]] expected',
                    method=method,
                )
        if self.methods == ["2-phase"] and self.view:
            raise rule_broken(
                'method "2-phase" computes no images; no table [[view]] expected'
            )
        return self

    @model_validator(mode="after")
    def _ports_for_the_method(self) -> "Study":
        facade = [METHODS[method].facade for method in self.methods]
        ports = any(window.ports for window in self.window)
        if ports and not all(facade):
            raise rule_broken(
                '"ports" by method "{method}"; "4-phase" or "6-phase" expected',
                method=self.methods[facade.index(False)],
            )
        if any(facade) and not ports:
            raise rule_broken(
                'method "{method}" without ports; the key "ports" of a table'
                " [[window]] expected",
                method=self.methods[facade.index(True)],
            )
        return self

    @model_validator(mode="after")
    def _sun_of_the_method(self) -> "Study":
        exact = "places" in self.sun.model_fields_set and self.sun.places == "exact"
        if exact and all(METHODS[m].correction == "never" for m in self.methods):
            raise rule_broken(
                'method "{method}" distributes the sun over sky patches; sun "patches",'
                ' or method "{other}" with the exact sun, expected',
                method=self.method,
                other="6-phase" if METHODS[self.method].facade else "5-phase",
            )
        return self

    @model_validator(mode="after")
    def _openings_for_the_sun(self) -> "Study":
        if self.sunlight and not (self.window or self.sunlight.file):
            raise rule_broken(
                "[sunlight] without a window; its openings as a file expected"
            )
        return self

    @model_validator(mode="after")
    def _names_that_exist(self) -> "Study":
        # Grids, views and zones named in rules, zones and luminaires must exist
        grids = [table.label for table in self.sensors]
        views = [table.label for table in self.view]
        for window in self.window:
            if window.control is not None:
                rule = f'rule "{window.control.rule}" of window "{window.label}"'
                _require(rule, "grid", [window.control.grid], grids)
                _require(rule, "view", window.control.views, views)
                self._require_views(window)
        zones = [table.label for table in self.lighting]
        for zone in self.lighting:
            _require(f'lighting "{zone.label}"', "grid", [zone.grid], grids)
        for lamp in self.luminaire:
            what = f'luminaire "{lamp.label}"'
            _require(what, "lighting zone", [lamp.zone], zones)
            if not lamp.zone and len(zones) > 1:
                raise rule_broken(
                    "{what} without zone; one of {zones} expected",
                    what=what,
                    zones=", ".join(zones),
                )
        if bool(self.luminaire) != bool(self.lighting):
            raise rule_broken(
                "[[luminaire]] and [[lighting]]: one without the other; both expected"
            )
        return self

    def _require_views(self, window: WindowTable) -> None:
        control = window.control
        if control is None or self.view:
            return
        if control.rule == "glare" and control.grid:
            return
        looks = control.rule == "glare" or "glare" in control.needs
        if looks or control.dgp_below is not None:
            raise rule_broken(
                'rule "{rule}" of window "{name}" depends on glare, but there is no'
                " view; a table [[view]] expected",
                rule=control.rule,
                name=window.label,
            )

    @property
    def method(self) -> MethodName:
        """Phase method; the first one if several are compared."""
        return self.methods[0]

    @property
    def corrected(self) -> bool:
        """Whether the direct correction is applied."""
        choice = METHODS[self.method].correction
        return choice == "always" or (choice == "choice" and self.sun.places == "exact")

    @property
    def terms(self) -> tuple[Term, ...]:
        """Terms of the matrix equation."""
        return METHODS[self.method].terms(corrected=self.corrected)

    @property
    def folder(self) -> Path:
        """Folder of the study file."""
        return self._folder

    def with_method(self, method: MethodName) -> "Study":
        """Return the study with one method; without views for the two-phase method."""
        change: dict[str, Any] = {"methods": [method]}
        if method == "2-phase":
            change["view"] = []
        return self.model_copy(update=change)

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
        """Return the study with another seed, device or cluster, if given."""
        given = {"seed": seed, "device": device, "cluster": cluster}
        change = {key: value for key, value in given.items() if value is not None}
        trace = self.trace.model_copy(update=change)
        return self.model_copy(update={"trace": trace})

    def facts(self) -> dict[str, Any]:
        """Return all keys and values, with file paths relative to the study folder."""

        def plain(value: Any) -> Any:
            if isinstance(value, dict):
                return {key: plain(item) for key, item in value.items()}
            if isinstance(value, list):
                return [plain(item) for item in value]
            if isinstance(value, Path):
                inside = value.is_relative_to(self._folder)
                return (value.relative_to(self._folder) if inside else value).as_posix()
            return value

        facts = {key: plain(v) for key, v in self.model_dump(by_alias=True).items()}
        if len(self.methods) == 1:
            facts["method"] = self.method
        return facts

    def to_json(self) -> str:
        """Return all keys and values as JSON."""
        return json.dumps(self.facts(), sort_keys=True)


def _require(what: str, kind: str, names: list[str], known: list[str]) -> None:
    for name in names:
        if name and name not in known:
            raise rule_broken(
                '{what} refers to {kind} "{name}"; one of {known} expected',
                what=what,
                kind=kind,
                name=name,
                known=", ".join(known) or "none",
            )


def read_study(path: str | Path) -> Study:
    """Read a study from a TOML file; its paths are relative to that file.

    Raises
    ------
    InputError : the file cannot be read, is not TOML, or a key is missing,
        unknown or wrong; with the line and the valid choices
    """
    path = Path(path)
    study = read_table(Study, path, {"folder": path.parent})
    return study.model_copy(update={"title": study.title or path.stem})
