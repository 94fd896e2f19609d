"""Gas-filled gaps between the layers of a glazing system."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import final

from clerestory.errors import InputError

GASES = ("air", "argon", "krypton", "xenon")

# Standard atmosphere [Pa].
ATMOSPHERE = 101_325.0


@final
@dataclass(frozen=True)
class Gap:
    """The space between two layers.

    Attributes
    ----------
    thickness : [m]
    gases : fractions of the gases, with a sum of 1
    pressure : [Pa]

    Raises
    ------
    InputError : no thickness, unknown gases, or another sum

    Examples
    --------
    >>> Gap(0.016, {"argon": 0.9, "air": 0.1}).thickness
    0.016
    """

    thickness: float
    gases: Mapping[str, float] = field(default_factory=lambda: {"air": 1.0})
    pressure: float = ATMOSPHERE

    def __post_init__(self) -> None:
        if not (self.thickness > 0 and self.pressure > 0):
            raise InputError(
                f"a gap of {self.thickness:g} m at {self.pressure:g} Pa; both above 0"
                " expected"
            )
        unknown = [name for name in self.gases if name not in GASES]
        if unknown:
            raise InputError(
                f"unknown gas {unknown[0]!r}; one of {', '.join(GASES)} expected"
            )
        total = sum(self.gases.values())
        if min(self.gases.values(), default=0) < 0 or abs(total - 1) > 1e-6:
            raise InputError(f"shares of gases sum to {total:g}; 1 expected")
