"""Result of a glare evaluation: sources, photometric quantities and indices."""

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from clerestory.glare.dgp import age_correction, dgp, low_light_correction
from clerestory.glare.index import EyePhotometry
from clerestory.glare.indices import REPORTED


@dataclass(frozen=True, eq=False, kw_only=True)
class Glare(EyePhotometry):
    """Glare sources, photometric quantities and glare indices of one picture."""

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

    def values(self) -> dict[str, float]:
        """Return all indices and photometric quantities by name."""
        found = {one.name: one.formula(self) for one in REPORTED}
        return found | {"dgp": self.dgp}
