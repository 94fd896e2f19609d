"""Tables of the study file for EnergyPlus: model of the building, and its objects."""

from typing import Annotated, Literal

from pydantic import Field, model_validator

from clerestory.documents import Table
from clerestory.study.config_tables import require_rule
from clerestory.study.file_fields import InputFile

Name = Annotated[str, Field(min_length=1, max_length=100)]


class EnergyWindowTable(Table):
    """Window group of the study, and the same windows in the model of EnergyPlus."""

    name: str = Field(description="the name of a table [[window]]")
    surfaces: list[Name] = Field(
        min_length=1, description="a list of FenestrationSurface:Detailed objects"
    )
    constructions: list[Name] = Field(
        min_length=1, description="a list of constructions, one for each shade state"
    )


class EnergyLightsTable(Table):
    """Lighting zone of the study, and the same luminaires in the model."""

    zone: str = Field("", description="the name of a table [[lighting]]")
    lights: Name = Field(description="the name of a Lights object")


class EnergyTable(Table):
    """Heating and cooling by EnergyPlus, with the shades and lights of the study.

    `solar` is the source of the solar radiation of windows and rooms: EnergyPlus, or
    the matrices of the study. `comfort_c` is the range of operative temperature in
    which occupants are comfortable [°C].
    """

    model: InputFile = Field(description="a model of EnergyPlus, .idf or .epJSON")
    weather: InputFile | None = Field(None, description="an EPW file")
    window: list[EnergyWindowTable] = Field(
        default_factory=list, description="tables [[energy.window]]"
    )
    lights: list[EnergyLightsTable] = Field(
        default_factory=list, description="tables [[energy.lights]]"
    )
    solar: Literal["EnergyPlus", "matrices"] = "EnergyPlus"
    comfort_c: list[float] = Field([20.0, 26.0], min_length=2, max_length=2)

    @model_validator(mode="after")
    def _rules(self) -> "EnergyTable":
        low, high = self.comfort_c
        require_rule(
            low < high, f"comfort_c = [{low:g}, {high:g}]; the lower limit first"
        )
        surfaces = [s.casefold() for each in self.window for s in each.surfaces]
        twice = next((s for s in surfaces if surfaces.count(s) > 1), None)
        require_rule(
            twice is None,
            f'surface "{twice}" is named twice; one window group expected',
        )
        return self
