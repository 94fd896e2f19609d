"""Result of a glare evaluation, and list of the indices and quantities that it reports.

To add an index, write a module with the formula and add a line here.
"""

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field

from clerestory.array_types import Series
from clerestory.brief_repr import brief
from clerestory.glare.cgi import CGI
from clerestory.glare.dgi import DGI, MODIFIED_DGI
from clerestory.glare.dgp import DGP, SIMPLIFIED_DGP
from clerestory.glare.index import EyePhotometry, GlareIndex, Quantity
from clerestory.glare.index_settings import IndexSettings
from clerestory.glare.source_table import GlareSources
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
        lambda e: e.sources.totals(e.sources.solid_angle),
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
    Quantity("source_count", lambda e: e.sources.counts.astype(float)),
    Quantity("brightest_luminance", lambda e: e.brightest, _CD),
    Quantity("reference_luminance", lambda e: e.reference, _CD),
)

INDICES = tuple(one for one in REPORTED if isinstance(one, GlareIndex))


def quantities_over_time(
    eye: EyePhotometry, names: Collection[str] | None = None
) -> dict[str, Series]:
    """Return indices and photometric quantities by name; default: all."""
    wanted = [one for one in REPORTED if names is None or one.name in names]
    return {one.name: one.formula(eye) for one in wanted}


@dataclass(frozen=True, eq=False)
class Glare:
    """Glare sources, photometric quantities and glare indices of one picture.

    `errors` are the standard errors of the `values`, if those of the pixels are known.
    """

    eye: EyePhotometry
    errors: Mapping[str, float] = field(default_factory=dict)

    __repr__ = brief

    @property
    def sources(self) -> GlareSources:
        """Glare sources."""
        return self.eye.sources

    @property
    def settings(self) -> IndexSettings:
        """Settings of the indices."""
        return self.eye.settings

    @property
    def illuminance(self) -> float:
        """Vertical illuminance at the eye, from the picture [lux]."""
        return float(self.eye.illuminance[0])

    @property
    def direct_illuminance(self) -> float:
        """Vertical illuminance at the eye from the glare sources, Edir [lux]."""
        return float(self.eye.direct_illuminance[0])

    @property
    def average(self) -> float:
        """Mean luminance of the picture [cd/m²]."""
        return float(self.eye.average[0])

    @property
    def reference(self) -> float:
        """Mean luminance of the task, if any, else of the picture [cd/m²]."""
        return float(self.eye.reference[0])

    @property
    def background(self) -> float:
        """Background luminance as defined by the settings [cd/m²]."""
        return float(self.eye.background[0])

    @property
    def brightest(self) -> float:
        """Largest luminance [cd/m²]."""
        return float(self.eye.brightest[0])

    @property
    def dgp(self) -> float:
        """Daylight glare probability, with the corrections for low light and age."""
        return self.values(("dgp",))["dgp"]

    def values(self, names: Collection[str] | None = None) -> dict[str, float]:
        """Return indices and photometric quantities by name; default: all."""
        found = quantities_over_time(self.eye, names)
        return {name: float(value[0]) for name, value in found.items()}
