"""Tables of the study file for electric light: luminaires and lighting zones."""

from typing import Literal

from pydantic import Field, model_validator

from clerestory.metrics.lighting_energy import Control
from clerestory.study.config_tables import (
    Named,
    NamedFile,
    Place,
    require_rule,
)
from clerestory.study.file_fields import InputFile


class LuminaireTable(NamedFile):
    """Luminaires of one type at given positions, or a scene file of light sources."""

    file: InputFile = Field(
        description="a photometric file (.ies, .ldt) or a Radiance file (.rad)"
    )
    places: list[Place] = Field(
        default_factory=list, description="a list of places [x, y, z]"
    )
    turn_deg: float = 0.0
    tilt_deg: float = 0.0
    output: float = Field(1.0, gt=0, le=10)
    power: float | None = Field(None, gt=0)
    zone: str = ""
    spectrum: InputFile | None = Field(
        None, description="a file of wavelengths [nm] and spectral power"
    )

    @property
    def photometric(self) -> bool:
        """Whether `file` is a photometric file, not a scene file."""
        return self.file.suffix.lower() in (".ies", ".ldt")

    @model_validator(mode="after")
    def _places_for_the_file(self) -> "LuminaireTable":
        placed = {"places", "turn_deg", "tilt_deg"} & self.model_fields_set
        require_rule(
            not self.photometric or self.places,
            'a photometric file without "places"; a list of [x, y, z] expected',
        )
        require_rule(
            self.photometric or not placed,
            '"places", "turn_deg" or "tilt_deg" with a scene file; none expected',
        )
        require_rule(
            self.photometric or self.power is not None,
            'a scene file without "power"; the total power in watts expected',
        )
        return self


class LightingTable(Named):
    """Lighting zone: luminaires that are controlled by one photosensor."""

    control: Control = Field(
        "dimming",
        description='"dimming", "dimming with switch-off", "on-off" or "none"',
    )
    grid: str = ""
    reading: Literal["mean", "lowest"] = "mean"
    setpoint_lux: float = Field(500.0, gt=0)
    least_output: float = Field(0.1, ge=0, lt=1)
    least_power: float = Field(0.2, ge=0, le=1)
    standby: float = Field(0.0, ge=0)

    @model_validator(mode="after")
    def _sensor(self) -> "LightingTable":
        require_rule(
            self.control == "none" or self.grid,
            f'control "{self.control}" without "grid"; the grid of the photosensors'
            " expected",
        )
        return self
