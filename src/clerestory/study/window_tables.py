"""Tables of the study file for windows: shade states and control rules.

Shade states are numbered from 0, the most open, to the most closed.
"""

import itertools
import operator
from typing import Annotated, Literal

from pydantic import Field, model_validator

from clerestory.control.lm83_blinds import MOST_SENSORS, SUN_LUX
from clerestory.control.season import SEASONS
from clerestory.documents import Table
from clerestory.escaping import printable
from clerestory.study.bsdf_field import BSDF, BsdfFile
from clerestory.study.config_tables import (
    Distinct,
    Named,
    NamedFile,
    require_one_of,
    require_rule,
)
from clerestory.study.control_fields import Levels, StateChoice, Tilts
from clerestory.study.file_fields import InputFile

RuleName = Literal[
    "fixed",
    "cut-off",
    "profile angle",
    "threshold",
    "glare",
    "best",
    "melanopic",
    "LM-83",
    "season",
    "schedule",
    "python",
    "cooling season",
    "predictive",
]
Quantity = Literal[
    "facade irradiance",
    "facade illuminance",
    "facade direct irradiance",
    "global horizontal",
    "diffuse horizontal",
    "direct normal",
    "illuminance",
    "melanopic EDI",
    "outdoor temperature",
    "zone temperature",
    "heating load",
    "cooling load",
]
Need = Literal["illuminance", "melanopic EDI", "glare"]

# Quantities that depend on the states of other groups
INTERIOR = ("illuminance", "melanopic EDI")

# Keys of the glare limit of rules that know the zone
_GLARE = ("dgp_below", "views", "view_grids", "eye_grid")

# Required and optional keys of each rule
_KEYS: dict[RuleName, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "fixed": (("state",), ()),
    "cut-off": (
        ("tilts_deg", "slat_width", "slat_spacing"),
        ("vertical", "sun_above"),
    ),
    "profile angle": (("angles_deg",), ("vertical", "sun_above")),
    "threshold": (
        ("close_above",),
        ("quantity", "open_below", "close_after", "open_after", "grid"),
    ),
    "glare": ((), ("dgp_below", "views", "view_grids", "grid")),
    "best": (
        ("grid",),
        ("target_lux", "lux_below", "dgp_below", "views", "view_grids"),
    ),
    "melanopic": (
        ("grid",),
        ("target_lux", "dgp_below", "views", "view_grids", "state"),
    ),
    "LM-83": ((), ("grid", "sun_lux", "most_sensors")),
    "season": ((), SEASONS),
    "schedule": (("file",), ()),
    "python": (("function",), ("needs", "views", "view_grids")),
    "cooling season": (("grid",), ("target_lux", "season_above", *_GLARE)),
    "predictive": (
        (),
        (
            "horizon",
            "temperature_error",
            "gain_error",
            "heating_weight",
            "cooling_weight",
            "lighting_weight",
            "movement_cost",
            "view_cost",
            *_GLARE,
        ),
    ),
}
_EVERY_RULE = ("rule", "when_empty")


class LayerTable(Table):
    """High-resolution BSDF and exterior shade of a window or shade state."""

    sun_bsdf: BsdfFile | None = Field(
        None, description="a BSDF file (.xml) of high resolution"
    )
    peak: bool = Field(False, description="true if view through the layer is clear")
    spectrum: InputFile | None = Field(
        None, description="a file of the spectral transmittance at normal incidence"
    )
    shade: list[InputFile] = Field(
        default_factory=list, description="a list of Radiance scene files"
    )


class StateTable(Named, LayerTable):
    """Shade state of a window."""

    bsdf: BsdfFile = Field(description=BSDF)

    @property
    def label(self) -> str:
        """Name of the shade state, by default the stem of the BSDF file name."""
        return self.name or printable(self.bsdf.stem)


class ControlTable(Table):
    """Control rule for the shade states of a window."""

    rule: RuleName = Field(description="the name of a rule")
    when_empty: StateChoice | None = None
    state: StateChoice = 0
    winter: StateChoice = 0
    spring: StateChoice = 0
    summer: StateChoice = 0
    autumn: StateChoice = 0
    slat_width: float | None = Field(None, gt=0, description="metres")
    slat_spacing: float | None = Field(None, gt=0, description="metres")
    tilts_deg: Tilts = Field(
        default_factory=list, description="a list of tilts, one for each state"
    )
    vertical: bool = False
    angles_deg: list[Annotated[float, Field(ge=-90, le=90)]] = Field(
        default_factory=list, description="a list of falling angles"
    )
    sun_above: float = Field(50.0, ge=0)
    quantity: Quantity = "facade irradiance"
    close_above: Levels = Field(
        default_factory=list, description="a number, or a list of them"
    )
    open_below: Levels | None = None
    close_after: float = Field(0.0, ge=0, description="minutes")
    open_after: float = Field(0.0, ge=0, description="minutes")
    grid: str = ""
    views: list[str] = Field(default_factory=list, description="a list of views")
    view_grids: list[str] = Field(
        default_factory=list, description="a list of view grids"
    )
    dgp_below: float | None = Field(None, gt=0, le=1)
    target_lux: float | None = Field(None, gt=0)
    lux_below: float | None = Field(None, gt=0)
    sun_lux: float = Field(SUN_LUX, gt=0)
    most_sensors: float = Field(MOST_SENSORS, ge=0, le=1)
    eye_grid: str = ""
    season_above: float | None = Field(None, ge=-50, le=50, description="degrees C")
    horizon: float = Field(24.0, gt=0, le=168, description="hours")
    temperature_error: float = Field(0.0, ge=0, le=20, description="kelvins")
    gain_error: float = Field(0.0, ge=0, le=1)
    heating_weight: float = Field(1.0, ge=0)
    cooling_weight: float = Field(1.0, ge=0)
    lighting_weight: float = Field(1.0, ge=0)
    movement_cost: float = Field(0.0, ge=0, description="kWh")
    view_cost: float = Field(0.0, ge=0, description="kWh")
    file: InputFile | None = Field(None, description="a file of states (.csv)")
    function: str = Field(
        "",
        pattern=r"^[^:]+\.py:[^\W\d]\w*$",
        description='"FILE.py:FUNCTION"',
    )
    needs: list[Need] = Field(
        default_factory=list,
        description='a list of "illuminance", "melanopic EDI" and "glare"',
    )

    @property
    def melanopic(self) -> bool:
        """Whether the rule depends on melanopic light."""
        wanted = {self.rule, self.quantity, *self.needs}
        return bool(wanted & {"melanopic", "melanopic EDI"})

    @model_validator(mode="after")
    def _keys_of_the_rule(self) -> "ControlTable":
        must, may = _KEYS[self.rule]
        given = {f for f in self.model_fields_set if f not in _EVERY_RULE}
        for key in sorted(given - {*must, *may}):
            known = ", ".join((*must, *may))
            message = f'rule "{self.rule}" has no key "{key}"; one of {known} expected'
            require_rule(False, message)
        for key in must:
            require_rule(
                key in given, f'rule "{self.rule}" without "{key}"; a value expected'
            )
        return self

    @model_validator(mode="after")
    def _levels_in_pairs(self) -> "ControlTable":
        low, high = self.open_below or self.close_above, self.close_above
        require_rule(
            len(low) == len(high) and all(map(operator.le, low, high)),
            '"open_below" does not match "close_above"; as many numbers, each at most'
            ' that of "close_above", expected',
        )
        require_rule(
            self.quantity not in INTERIOR or self.grid,
            f'quantity "{self.quantity}" without "grid"; the name of a grid expected',
        )
        falls = itertools.starmap(operator.gt, itertools.pairwise(self.angles_deg))
        expected = "each angle below the one before expected"
        require_rule(all(falls), f'"angles_deg" are not in falling order; {expected}')
        return self


class WindowTable(NamedFile, LayerTable):
    """Window group: polygons with one BSDF, or with several shade states."""

    file: InputFile = Field(description="a Radiance file of window polygons")
    bsdf: BsdfFile | None = Field(None, description=BSDF)
    ports: InputFile | None = Field(
        None, description="a Radiance file of ports whose front faces the window"
    )
    state: Annotated[list[StateTable], Distinct] = Field([])
    control: ControlTable | None = Field(None, description="a table [window.control]")

    @model_validator(mode="after")
    def _one_kind_of_bsdf(self) -> "WindowTable":
        require_one_of({'"bsdf"': self.bsdf, "[[window.state]]": self.state})
        for key in sorted({"sun_bsdf", "peak", "shade"} & self.model_fields_set):
            require_rule(
                not self.state,
                f'"{key}" beside [[window.state]]; a key of each state expected',
            )
        require_rule(
            self.ports or not any(state.shade for state in self.states()),
            '"shade" without "ports"; a file of ports around the shade expected',
        )
        self._check_control()
        return self

    def _check_control(self) -> None:
        # Check the shade states named in the control rule, and the lengths of its lists
        control, labels = self.control, [table.label for table in self.states()]
        if control is None:
            return
        seasons = [getattr(control, season) for season in SEASONS]
        for choice in (control.state, control.when_empty, *seasons):
            require_rule(
                choice in (None, *range(len(labels)), *labels),
                f"no state {choice!r}; a number below {len(labels)} or one of"
                f" {', '.join(labels)} expected",
            )
        last = len(labels) - 1
        for key, values, count in (
            ("tilts_deg", control.tilts_deg, len(labels)),
            ("angles_deg", control.angles_deg, last),
            ("close_above", control.close_above, last),
        ):
            one = key == "close_above" and len(values) == 1
            require_rule(
                key not in control.model_fields_set or len(values) == count or one,
                f'"{key}" has {len(values)} numbers; {count} expected for {len(labels)}'
                " states",
            )

    def states(self) -> list[StateTable]:
        """Return the shade states; a window with one BSDF has a single state."""
        if self.bsdf is None:
            return list(self.state)
        keys = {name: getattr(self, name) for name in LayerTable.model_fields}
        return [StateTable.model_construct(name="", bsdf=self.bsdf, **keys)]
