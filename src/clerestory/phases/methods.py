"""Phase methods as terms of the matrix equation.

    2-phase   I = C S
    3-phase   I = V T D S
    4-phase   I = V T F D S
    5-phase   I = V T D S − V_d T D_d S_ds + C_ds S_sun
    6-phase   I = V T F D S − V_d T F_d D_d S_ds + C_ds S_sun

The direct correction subtracts direct sunlight computed with the sun spread over sky
patches, and adds direct sunlight computed with the sun at its true position and with
the window BSDF at full resolution. In the two-phase method the direct correction is
optional: I = C S − C_d S_ds + C_ds S_sun.

References: P. R. Tregenza, I. M. Waters, Lighting Research and Technology 15 (2), 1983
(2-phase); S. Subramaniam, Daylighting simulations with Radiance using matrix-based
methods, LBNL, 2017 (4- and 6-phase); see `matrix_equation` for the others.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import xarray as xr

from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import Skies, States, Term, WindowMatrices
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.sun_matrix import SunMatrix

MethodName = Literal["2-phase", "3-phase", "4-phase", "5-phase", "6-phase"]

# Names of the result variables for the two terms of the direct correction
DIRECT_IN_PATCHES, DIRECT_SUN = "direct_in_patches", "direct_sun"


@dataclass(frozen=True)
class PhaseMethod:
    """Definition of a phase method.

    Attributes
    ----------
    whole : name of the result variable for the term with interreflections
    windows : True for V T D, False for daylight coefficients C
    facade : whether the method includes façade matrices (F)
    correction : whether the direct correction is always, never or optionally applied
    """

    whole: str
    windows: bool = True
    facade: bool = False
    correction: Literal["always", "never", "choice"] = "never"

    def terms(self, *, corrected: bool) -> tuple[Term, ...]:
        """Return the terms of the method, with or without the direct correction."""
        whole = Term(self.whole, "whole")
        if not corrected:
            return (whole,)
        spread = Term(DIRECT_IN_PATCHES, "direct", -1, sky="sun")
        return (whole, spread, Term(DIRECT_SUN, "sun"))

    def formula(self, term: Term) -> str:
        """Return the matrix product of a term as text.

        >>> [METHODS["6-phase"].formula(term) for term in FIVE_PHASE]
        ['V T F D S', 'V_d T F_d D_d S_ds', 'C_ds S_sun']
        """
        if term.part == "sun":
            return "C_ds S_sun"
        names = ["V", "T", *["F"] * self.facade, "D"] if self.windows else ["C"]
        if term.part == "direct":
            names = [name if name == "T" else f"{name}_d" for name in names]
        return " ".join([*names, "S" if term.sky == "whole" else "S_ds"])


METHODS: dict[MethodName, PhaseMethod] = {
    "2-phase": PhaseMethod("two_phase", windows=False, correction="choice"),
    "3-phase": PhaseMethod("three_phase"),
    "4-phase": PhaseMethod("four_phase", facade=True),
    "5-phase": PhaseMethod("three_phase", correction="always"),
    "6-phase": PhaseMethod("four_phase", facade=True, correction="always"),
}

THREE_PHASE = METHODS["3-phase"].terms(corrected=False)
FIVE_PHASE = METHODS["5-phase"].terms(corrected=True)


def three_phase(
    windows: Sequence[WindowMatrices], sky: SkyMatrix, states: States | None = None
) -> xr.Dataset:
    """Illuminance [lux] by the three-phase method, with its standard error.

    With F D in place of D, the result is that of the four-phase method.

    View matrices of several window groups must be traced together. `states` are indices
    of shade states at each time step, per window group, by default 0.
    """
    return illuminance(windows, THREE_PHASE, Skies(sky), states)


def five_phase(
    windows: Sequence[WindowMatrices],
    sky: SkyMatrix,
    sun_in_patches: SkyMatrix,
    suns: SunMatrix,
    states: States | None = None,
) -> xr.Dataset:
    """Illuminance [lux] by the three-phase method with direct correction.

    With F D in place of D, the result is that of the six-phase method.

    Parameters
    ----------
    sky : S, radiance of sky, sun and ground
    sun_in_patches : S_ds, radiance of the sun alone, spread over the same patches
    suns : S_sun, irradiance of the suns at their true positions, the columns of C_ds
    states : index of the shade state at each time step, per window group; default 0

    Returns
    -------
    `illuminance`, `standard_error` and the terms `three_phase`, `direct_in_patches` and
    `direct_sun` over (sensor, time)
    """
    skies = Skies(sky, sun_in_patches, suns)
    return illuminance(windows, FIVE_PHASE, skies, states)
