"""Result of a glare evaluation, and list of the indices and quantities that it reports.

To add an index, write a module with the formula and add a line here.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from clerestory.brief_repr import brief
from clerestory.glare.cgi import CGI
from clerestory.glare.dgi import DGI, MODIFIED_DGI
from clerestory.glare.dgp import (
    DGP,
    SIMPLIFIED_DGP,
    age_correction,
    dgp,
    low_light_correction,
)
from clerestory.glare.index import EyePhotometry, GlareIndex, Quantity
from clerestory.glare.ugp import LOGISTIC_UGP, UGP
from clerestory.glare.ugr import EXPERIMENTAL_UGR, UGR
from clerestory.glare.vcp import DGR, VCP
from clerestory.glare.veiling import CIE_VEILING_LUMINANCE, POYNTER_VEILING_LUMINANCE

_CD = "cd/m2"

# Ordered as the columns of evalglare -d
REPORTED: tuple[Quantity, ...] = (
    DGP,
    Quantity("average_luminance", lambda e: e.average, _CD, "av_lum"),
    Quantity("illuminance", lambda e: e.illuminance, "lux", "E_v"),
    Quantity("background_luminance", lambda e: e.background, _CD, "lum_backg"),
    Quantity("direct_illuminance", lambda e: e.direct_illuminance, "lux", "E_v_dir"),
    DGI,
    UGR,
    VCP,
    CGI,
    Quantity(
        "source_luminance", lambda e: e.sources.average_luminance(), _CD, "lum_sources"
    ),
    Quantity(
        "source_solid_angle",
        lambda e: float(e.sources.solid_angle.sum()),
        "sr",
        "omega_sources",
    ),
    POYNTER_VEILING_LUMINANCE,
    CIE_VEILING_LUMINANCE,
    DGR,
    UGP,
    EXPERIMENTAL_UGR,
    MODIFIED_DGI,
    LOGISTIC_UGP,
    SIMPLIFIED_DGP,
    Quantity("source_count", lambda e: float(e.sources.count)),
    Quantity("brightest_luminance", lambda e: e.brightest, _CD),
    Quantity("reference_luminance", lambda e: e.reference, _CD),
)

INDICES = tuple(one for one in REPORTED if isinstance(one, GlareIndex))


@dataclass(frozen=True, eq=False, kw_only=True)
class Glare(EyePhotometry):
    """Glare sources, photometric quantities and glare indices of one picture.

    `errors` are the standard errors of the `values`, if those of the pixels are known.
    """

    errors: Mapping[str, float] = field(default_factory=dict)

    __repr__ = brief

    @cached_property
    def dgp(self) -> float:
        """Daylight glare probability, with the corrections for low light and age."""
        level, settings = self.eye_illuminance, self.settings
        value = dgp(self.sources, illuminance=level, coefficients=settings.coefficients)
        if settings.low_light:
            value *= float(low_light_correction(np.array(level)))
        if settings.age is not None:
            value *= age_correction(settings.age)
        return min(value, 1.0)

    def values(self, names: Collection[str] | None = None) -> dict[str, float]:
        """Return indices and photometric quantities by name; default: all."""
        wanted = [one for one in REPORTED if names is None or one.name in names]
        return {
            one.name: self.dgp if one is DGP else one.formula(self) for one in wanted
        }
