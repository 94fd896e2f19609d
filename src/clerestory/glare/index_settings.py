"""Settings of the glare indices: background luminance, and corrections of DGP."""

from dataclasses import dataclass
from typing import Literal, get_args

from clerestory.checks import one_of

Background = Literal["cie", "average", "illuminance"]


@dataclass(frozen=True)
class DgpCoefficients:
    """Coefficients of the DGP equation.

    DGP = c1·Ev^a5 + c2·log10(1 + Σ L^a1·ω^a2 / (Ev^a3·P^a4)) + c3. The defaults are
    those of evalglare; the published values are c1 = 5.87e-5, c2 = 0.0918, c3 = 0.16.
    """

    c1: float = 5.87e-5
    c2: float = 0.092
    c3: float = 0.159
    a1: float = 2.0
    a2: float = 1.0
    a3: float = 1.87
    a4: float = 2.0
    a5: float = 1.0


EVALGLARE = DgpCoefficients()


@dataclass(frozen=True)
class IndexSettings:
    """Settings of the glare indices, as in `evaluate_glare`."""

    background: Background = "cie"
    given_illuminance: float | None = None
    low_light: bool = False
    age: float | None = None
    coefficients: DgpCoefficients = EVALGLARE

    def __post_init__(self) -> None:
        one_of(self.background, "background", choices=get_args(Background))
