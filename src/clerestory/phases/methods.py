"""Phase methods, as terms of the matrix equation.

    2-phase   I = C S
    3-phase   I = V T D S
    4-phase   I = V T F D S
    5-phase   I = V T D S − V_d T D_d S_ds + C_ds S_sun
    6-phase   I = V T F D S − V_d T F_d D_d S_ds + C_ds S_sun

The direct correction takes away what the sun, spread over patches, sends straight to
the receivers, and adds it with the sun at its place and the window's BSDF as fine as
it is known. The two-phase method has it as well: I = C S − C_d S_ds + C_ds S_sun.

References: P. R. Tregenza, I. M. Waters, Lighting Research and Technology 15 (2), 1983
(2-phase); S. Subramaniam, Daylighting simulations with Radiance using matrix-based
methods, LBNL, 2017 (4- and 6-phase); see `matrix_equation` for the others.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal

import xarray as xr

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    States,
    Term,
    WindowMatrices,
    window_chain,
)
from clerestory.progress import Progress
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.sky.sun_matrix import SunMatrix

MethodName = Literal["2-phase", "3-phase", "4-phase", "5-phase", "6-phase"]

# Names of the terms of the direct correction in results
DIRECT_IN_PATCHES, DIRECT_SUN = "direct_in_patches", "direct_sun"


@dataclass(frozen=True)
class PhaseMethod:
    """What a phase method multiplies.

    Attributes
    ----------
    whole : name of the term with all reflections, in results
    windows : whether light passes windows by V T D; else daylight coefficients lead
        from the receivers straight to the sky
    facade : whether exterior shades stand between window and ports (F)
    correction : whether the direct correction is "always" part of the method, "never",
        or by "choice"
    """

    whole: str
    windows: bool = True
    facade: bool = False
    correction: Literal["always", "never", "choice"] = "never"

    def terms(self, *, corrected: bool) -> tuple[Term, ...]:
        """Return the terms, with or without the direct correction."""
        whole = Term(self.whole, "whole")
        if not corrected:
            return (whole,)
        spread = Term(DIRECT_IN_PATCHES, "direct", -1, sky="sun")
        return (whole, spread, Term(DIRECT_SUN, "sun"))

    def formula(self, term: Term) -> str:
        """Return the matrices of a term.

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


def two_phase(
    coefficients: TransferMatrix, sky: SkyMatrix, *, progress: Progress | None = None
) -> xr.Dataset:
    """Illuminance [lux] over (sensor, time), with its standard error, as float32.

    Parameters
    ----------
    coefficients : from sky patches to sensors [sr]
    sky : radiance of each patch at each time
    progress : called with the share done, 0…1, and a note

    Raises
    ------
    MatrixError : the matrices do not fit each other
    """
    windows = [WindowMatrices(MatrixChain((coefficients,)))]
    terms = METHODS["2-phase"].terms(corrected=False)
    return illuminance(windows, terms, Skies(sky), progress=progress)


def three_phase(
    view: TransferMatrix,
    transmission: TransferMatrix,
    daylight: TransferMatrix,
    sky: SkyMatrix,
) -> xr.Dataset:
    """Illuminance [lux] behind one window group, with its standard error.

    Raises
    ------
    MatrixError : two of the matrices do not fit each other
    """
    window = WindowMatrices(window_chain(view, transmission, daylight))
    return three_phase_sum([window], sky)


def three_phase_sum(
    windows: Sequence[WindowMatrices],
    sky: SkyMatrix,
    states: States | None = None,
    *,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Illuminance [lux] behind several window groups, with its standard error.

    With F D in place of D this is the four-phase method.

    Parameters
    ----------
    windows : their view matrices have the same sensors and were traced together
    states : number of the state at each step, per window; by default the first
    progress : called with the share done, 0…1, and a note

    Returns
    -------
    `illuminance` and `standard_error` over (sensor, time), float32

    Raises
    ------
    MatrixError : matrices do not fit each other, or states that do not exist
    """
    return illuminance(windows, THREE_PHASE, Skies(sky), states, progress=progress)


def five_phase(
    windows: Sequence[WindowMatrices],
    sky: SkyMatrix,
    sun_in_patches: SkyMatrix,
    suns: SunMatrix,
    states: States | None = None,
    *,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Illuminance [lux] by three phases and the direct correction.

    With F D in place of D this is the six-phase method.

    Parameters
    ----------
    windows : their matrices have the same sensors
    sky : S, with sky, sun and ground
    sun_in_patches : S_ds, the sun alone, spread over the same patches as in S
    suns : S_sun, the suns at their true places, those of the columns of C_ds
    states : number of the state at each step, per window; by default the first
    progress : called with the share done, 0…1, and a note

    Returns
    -------
    `illuminance` and `standard_error` over (sensor, time), and the equation's terms
    `three_phase`, `direct_in_patches` and `direct_sun`, float32

    Raises
    ------
    MatrixError : matrices do not fit each other, or skies have different times
    """
    skies = Skies(sky, sun_in_patches, suns)
    return illuminance(windows, FIVE_PHASE, skies, states, progress=progress)
