"""Tables of the study file for what is not known exactly.

Each kind of quantity has a default distribution and a physical range:

- reflectance ±0.05, transmittance ±3 %: assumed, for values from colour charts and data
  sheets; E. Brembilla, C. J. Hopfe, J. Mardaljevic, Journal of Building Performance
  Simulation 11 (3), 2018, show how much reflectances matter
- dirt: in a survey of 430 windows, vertical ones do not usually lose more than 10 %
  (S. Sharples, L. Stewart, P. R. Tregenza, Building and Environment 36 (4), 2001);
  P. R. Tregenza, S. Sharples, Daylight Algorithms, 1993, algorithm 2.13, give 0.9 for
  vertical glazing at clean places, and less at dirty ones
- BSDF ±5 %: assumed, between the 0.8 to 1.7 % of primary facilities (J. Fu et al.,
  Review of Scientific Instruments 94, 083102, 2023) and the 3 to 28 % by which measured
  and computed transmittance of a daylighting system differ (M. Krehel et al., Journal
  of Facade Design and Engineering 4, 2016)
- sky and sun ±6 %: bias of illuminance from modelled irradiance, International Journal
  of Photoenergy 2018, 8180526
- clock and gain: assumed, for a data logger and a photometer of class B
"""

from typing import Annotated, Literal, NamedTuple, Self

from pydantic import BeforeValidator, Field, model_validator

from clerestory.documents import Number, Positive, Table
from clerestory.study.config_tables import Named, require_rule
from clerestory.study.file_fields import InputFile

Kind = Literal[
    "reflectance",
    "transmittance",
    "dirt",
    "bsdf",
    "sky",
    "sun",
    "weather",
    "clock",
    "gain",
]


class Usual(NamedTuple):
    """Usual standard deviation and physical range of a kind of quantity, and its unit.

    `relative`: whether the deviation is a share of the value in the model.
    """

    deviation: float
    low: float
    high: float
    unit: str = ""
    relative: bool = False


USUAL: dict[str, Usual] = {
    "reflectance": Usual(0.05, 0.0, 0.99),
    "transmittance": Usual(0.03, 0.0, 0.99, relative=True),
    "dirt": Usual(0.0, 0.0, 1.0),
    "bsdf": Usual(0.05, 0.0, 2.0),
    "sky": Usual(0.06, 0.0, 3.0),
    "sun": Usual(0.06, 0.0, 3.0),
    "clock": Usual(5.0, -90.0, 90.0, "min"),
    "gain": Usual(0.05, 0.2, 3.0),
}

# Low end, mode and high end of the share of light that dirty glass lets pass
USUAL_DIRT = (0.85, 0.94, 1.0)

# Kinds that only measurements have
OF_MEASUREMENTS = ("clock", "gain")


def power_of_two(value: int) -> int:
    """Return a number of draws, or refuse it unless it is a power of two."""
    require_rule(
        isinstance(value, int) and value >= 4 and value & (value - 1) == 0,
        f"{value} draws; a power of two such as 2048 expected",
    )
    return value


class UnknownTable(Named):
    """A quantity that is not known exactly, and its distribution."""

    kind: Kind
    material: str = ""
    window: str = ""
    grid: str = ""
    distribution: Literal["normal", "uniform", "triangular"] | None = None
    mean: Number | None = None
    standard_deviation: Positive | None = None
    low: Number | None = None
    mode: Number | None = None
    high: Number | None = None
    files: list[InputFile] = Field([], description="a list of weather files")

    @property
    def label(self) -> str:
        """Name of the quantity, by default what it is of, and its kind."""
        of = self.material or self.window or self.grid
        kind = self.kind.replace("bsdf", "BSDF")
        return self.name or " ".join(filter(None, (of, kind)))

    @property
    def shape(self) -> str:
        """Name of the distribution."""
        default = "triangular" if self.kind == "dirt" else "normal"
        return self.distribution or default

    @model_validator(mode="after")
    def _of_what(self) -> Self:
        needs = {"reflectance": "material", "weather": "files"}.get(self.kind)
        require_rule(
            not needs or getattr(self, needs),
            f'kind "{self.kind}" without "{needs}"; one expected',
        )
        allowed = {
            "material": ("reflectance", "transmittance"),
            "window": ("transmittance", "dirt", "bsdf"),
            "grid": ("gain",),
            "files": ("weather",),
        }
        for key, kinds in allowed.items():
            require_rule(
                not getattr(self, key) or self.kind in kinds,
                f'kind "{self.kind}" with "{key}"; no "{key}" expected',
            )
        require_rule(
            not (self.material and self.window),
            'both "material" and "window"; one of them expected',
        )
        return self

    @model_validator(mode="after")
    def _keys_of_the_distribution(self) -> Self:
        keys = {
            "normal": ("mean", "standard_deviation", "low", "high"),
            "uniform": ("low", "high"),
            "triangular": ("low", "mode", "high"),
        }[self.shape]
        every = ("mean", "standard_deviation", "low", "mode", "high")
        given = [key for key in every if getattr(self, key) is not None]
        if self.kind == "weather":
            keys = ()
        other = next((key for key in given if key not in keys), None)
        require_rule(
            other is None,
            f'"{other}" of distribution "{self.shape}";'
            f" {', '.join(keys) or 'none of these keys'} expected",
        )
        missing = [key for key in keys if key not in given]
        usual = self.shape == "normal" or (self.kind == "dirt" and not given)
        require_rule(
            usual or self.kind == "weather" or not missing or missing == ["mode"],
            f'distribution "{self.shape}" without {" and ".join(missing)}; a number'
            " expected",
        )
        return self


class CorrelatedTable(Table):
    """Quantities that are correlated with each other."""

    unknowns: list[str] = Field(min_length=2, description="a list of names")
    correlation: Annotated[Number, Field(ge=-1, le=1)]


class UncertaintyTable(Table):
    """What is not known exactly, and how its effect is computed."""

    unknown: list[UnknownTable] = Field(
        min_length=1, description="at least one table [[uncertainty.unknown]]"
    )
    correlated: list[CorrelatedTable] = Field(
        default_factory=list, description="tables [[uncertainty.correlated]]"
    )
    draws: Annotated[int, BeforeValidator(power_of_two), Field(le=65_536)] = 2048
    checks: int = Field(4, ge=0, le=50)
    seed: int = Field(1, ge=0, lt=2**32)

    @model_validator(mode="after")
    def _names(self) -> Self:
        names = [own.label for own in self.unknown]
        twice = next((name for name in names if names.count(name) > 1), None)
        require_rule(
            twice is None,
            f'two quantities are named "{twice}"; different names expected',
        )
        for one in self.correlated:
            for name in one.unknowns:
                require_rule(
                    name in names,
                    f'correlated "{name}" is not the name of a quantity; one of'
                    f" {', '.join(names)} expected",
                )
        weather = [own for own in self.unknown if own.kind == "weather"]
        require_rule(len(weather) < 2, 'two quantities of kind "weather"; one expected')
        return self
