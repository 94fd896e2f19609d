"""What the eye makes of one picture: the sources and all indices of glare."""

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np

from clerestory.glare.cgi import cgi
from clerestory.glare.dgi import dgi, modified_dgi
from clerestory.glare.dgp import (
    EVALGLARE,
    DgpCoefficients,
    age_correction,
    dgp,
    low_light_correction,
    simplified_dgp,
)
from clerestory.glare.source_table import GlareSources
from clerestory.glare.ugp import logistic_ugp, ugp
from clerestory.glare.ugr import experimental_ugr, ugr
from clerestory.glare.vcp import dgr, vcp
from clerestory.glare.veiling import poynter_veiling_luminance, veiling_luminance

Background = Literal["cie", "average", "illuminance"]


@dataclass(frozen=True, eq=False, kw_only=True)
class Glare:
    """Glare of one picture.

    Attributes
    ----------
    sources : one row a source
    illuminance : on the eye, from the picture [lux]
    given_illuminance : on the eye as measured, which DGP is made with [lux]
    average : luminance of the picture by solid angle [cd/m²]
    reference : luminance of the task, or of the picture without one [cd/m²]
    brightest : luminance of the brightest pixel [cd/m²]
    solid_angle : of all pixels in view [sr]
    background_kind : "cie" is what reaches the eye beside the sources, over π;
        "average" is the mean of what is no source; "illuminance" is Ev/π
    low_light : correct DGP for dim rooms
    age : correct DGP for the age of the observer [years]; None for not
    coefficients : of DGP
    """

    sources: GlareSources
    illuminance: float
    given_illuminance: float | None = None
    average: float
    reference: float
    brightest: float
    solid_angle: float
    background_kind: Background = "cie"
    low_light: bool = False
    age: float | None = None
    coefficients: DgpCoefficients = EVALGLARE

    @cached_property
    def direct_illuminance(self) -> float:
        """Illuminance on the eye by the sources [lux]."""
        return float(self.sources.illuminance.sum())

    @cached_property
    def cie_background(self) -> float:
        """Luminance of a uniform field that lights the eye like all but the sources."""
        return (self.illuminance - self.direct_illuminance) / math.pi

    @cached_property
    def background(self) -> float:
        """Background luminance of the kind asked for [cd/m²]."""
        if self.background_kind == "cie":
            return self.cie_background
        if self.background_kind == "illuminance":
            return self.illuminance / math.pi
        omega = float(self.sources.solid_angle.sum())
        flux = float(self.sources.luminance @ self.sources.solid_angle)
        rest = self.solid_angle - omega
        return (self.solid_angle * self.average - flux) / rest if rest else self.average

    @cached_property
    def eye_illuminance(self) -> float:
        """Illuminance on the eye: the given one, else that of the picture [lux]."""
        given = self.given_illuminance
        return self.illuminance if given is None else given

    @cached_property
    def dgp(self) -> float:
        """Daylight glare probability, with the corrections asked for."""
        level = self.eye_illuminance
        value = dgp(self.sources, illuminance=level, coefficients=self.coefficients)
        if self.low_light:
            value *= float(low_light_correction(np.array(level)))
        if self.age is not None:
            value *= age_correction(self.age)
        return min(value, 1.0)

    def values(self) -> dict[str, float]:
        """Return all indices by name."""
        sources, level = self.sources, self.illuminance
        average = level / math.pi
        rating = dgr(sources, average=self.average)
        return {
            "dgp": self.dgp,
            "average_luminance": self.average,
            "illuminance": level,
            "background_luminance": self.background,
            "direct_illuminance": self.direct_illuminance,
            "dgi": dgi(sources, background=self.background),
            "ugr": ugr(sources, background=self.background),
            "vcp": vcp(rating),
            "cgi": cgi(sources, illuminance=level, direct=self.direct_illuminance),
            "source_luminance": sources.average_luminance(),
            "source_solid_angle": float(sources.solid_angle.sum()),
            "veiling_luminance": poynter_veiling_luminance(sources),
            "cie_veiling_luminance": float(veiling_luminance(sources).sum()),
            "dgr": rating,
            "ugp": ugp(sources, background=self.background),
            "experimental_ugr": experimental_ugr(
                sources, average=average, background=self.cie_background
            ),
            "modified_dgi": modified_dgi(sources, average=average),
            "logistic_ugp": logistic_ugp(sources, background=self.background),
            "simplified_dgp": float(simplified_dgp(np.array(self.eye_illuminance))),
            "source_count": float(sources.count),
            "brightest_luminance": self.brightest,
            "reference_luminance": self.reference,
        }
