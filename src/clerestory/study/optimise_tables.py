"""Table [optimise] of the study file: design variables, goals and limits."""

from typing import Annotated, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from clerestory.documents import Number, Positive, Table
from clerestory.study.config_tables import Named, require_rule
from clerestory.study.uncertainty_tables import UnknownTable, power_of_two


class VariableTable(Named):
    """A continuous design variable and its range."""

    kind: Literal["reflectance", "transmittance", "window share"]
    material: str = ""
    window: str = ""
    low: Positive
    high: Positive

    @property
    def label(self) -> str:
        """Name of the variable, by default what it is of, and its kind."""
        return self.name or f"{self.material or self.window} {self.kind}"

    @model_validator(mode="after")
    def _of_what(self) -> Self:
        key = "window" if self.kind == "window share" else "material"
        other = "material" if key == "window" else "window"
        require_rule(
            getattr(self, key) and not getattr(self, other),
            f'kind "{self.kind}"; "{key}", and no "{other}", expected',
        )
        require_rule(self.low < self.high, '"low" is not below "high"; less expected')
        require_rule(
            self.kind != "window share" or self.high <= 1,
            f"window share up to {self.high:g}; at most 1 expected",
        )
        return self

    def unknown(self) -> UnknownTable:
        """Return the variable as a quantity all of whose values are equally likely."""
        share = self.kind == "window share"
        return UnknownTable(
            name=self.label,
            kind="bsdf" if share else self.kind,  # type: ignore[arg-type]
            material=self.material,
            window=self.window,
            distribution="uniform",
            low=self.low,
            high=self.high,
        )


class FigureTable(Table):
    """A figure of merit: its name and grid."""

    figure: str = Field(min_length=1, description="the name of a figure of merit")
    place: str = ""


class GoalTable(FigureTable):
    """A figure of merit to improve."""

    aim: Literal["more", "less"] | None = None


class LimitTable(FigureTable):
    """A figure of merit that must stay within limits."""

    least: Number | None = None
    most: Number | None = None

    @model_validator(mode="after")
    def _limited(self) -> Self:
        given = (self.least, self.most) != (None, None)
        require_rule(given, 'a limit without "least" and "most"; one of them expected')
        return self


class OptimiseTable(Table):
    """Design variables, goals and limits of `clerestory optimise`."""

    variable: list[VariableTable] = Field(
        min_length=1, description="at least one table [[optimise.variable]]"
    )
    goal: list[GoalTable] = Field(
        min_length=1, max_length=3, description="one to three tables [[optimise.goal]]"
    )
    limit: list[LimitTable] = Field(
        default_factory=list, description="tables [[optimise.limit]]"
    )
    candidates: Annotated[int, BeforeValidator(power_of_two), Field(le=65_536)] = 1024
    designs: int = Field(6, ge=1, le=50)
    seed: int = Field(1, ge=0, lt=2**32)

    @model_validator(mode="after")
    def _names(self) -> Self:
        names = [own.label for own in self.variable]
        twice = next((name for name in names if names.count(name) > 1), None)
        require_rule(
            twice is None,
            f'two variables are named "{twice}"; different names expected',
        )
        return self
