"""Sensor matrices of a study, and their products with sky matrices."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

import numpy as np
import xarray as xr
from jaxtyping import Int

from clerestory.errors import InputError
from clerestory.metrics.space import DIRECT
from clerestory.phases.illuminance import illuminance
from clerestory.phases.illuminance_derivatives import illuminance_derivatives
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Part,
    Skies,
    States,
    Term,
    WindowMatrices,
)
from clerestory.phases.recent_values import RecentValues
from clerestory.progress import Progress
from clerestory.sky.sun_matrix import SunMatrix
from clerestory.spectral.alpha_opic import edi_weights

# File of hourly results of large studies, in their scratch folder
HOURLY_FILE = "illuminance.nc"


@dataclass(frozen=True, eq=False)
class StudyMatrices:
    """Traced sensor matrices of a study, by window group or of a scene with glazing.

    `suns` are the columns of C_ds. Hourly results are in files in `folder`, or in
    memory if `folder` is None. If view matrices are in files, memory is sufficient for
    `most_sensors` sensors. `recent` has products D S of other variants.
    """

    terms: tuple[Term, ...]
    windows: tuple[WindowMatrices, ...]
    suns: SunMatrix | None = None
    folder: Path | None = None
    most_sensors: int | None = None
    recent: RecentValues = field(default_factory=RecentValues)

    @property
    def has_direct(self) -> bool:
        """Whether direct matrices (V_d and D_d, C_d, or C_ds) were traced."""
        return all(window.direct or window.sun for window in self.windows)

    def illuminance(
        self,
        skies: Skies,
        states: States,
        *,
        progress: Progress | None = None,
        sun_apart: bool = False,
    ) -> xr.Dataset:
        """Illuminance [lux] over (sensor, time), with its errors; see `illuminance`.

        With `sun_apart`, that of the direct sun at its true position is in the same
        dataset, under the names of `DIRECT`, if all shades are in state 0.
        """
        opened = self.suns is not None and not any(map(np.any, states))
        return illuminance(
            self.windows,
            self.terms,
            skies,
            states,
            file=self.folder and self.folder / HOURLY_FILE,
            progress=progress,
            recent=self.recent,
            apart=DIRECT if sun_apart and opened else None,
        )

    def illuminance_derivatives(
        self,
        skies: Skies,
        states: States,
        *,
        second: Literal["all", "own", "none"] = "all",
    ) -> xr.Dataset:
        """Derivatives of the illuminance by parameters of materials."""
        return illuminance_derivatives(
            self.windows, self.terms, skies, states, second=second
        )

    def melanopic_edi(self, skies: Skies, states: States) -> xr.Dataset:
        """Melanopic EDI [lux] over (sensor, time), with its errors as illuminance."""
        return illuminance(
            self.windows,
            self.terms,
            skies,
            states,
            weights=edi_weights(skies.whole.bands, "melanopic"),
            file=self.folder and self.folder / "melanopic.nc",
        )

    def direct_illuminance(self, skies: Skies, states: States) -> xr.Dataset:
        """Direct sun illuminance [lux] over (sensor, time), with its errors.

        With C_ds the sun is at its true position, otherwise spread over sky patches.
        """
        if not self.has_direct:
            expected = 'method "5-phase" or "6-phase", or [sun] places = "exact",'
            raise InputError(f"direct light was not traced; {expected} expected")
        part: Part = "direct" if self.suns is None else "sun"
        term = Term("direct", part, sky="sun")
        file = self.folder and self.folder / "direct.nc"
        return illuminance(
            self.windows, (term,), skies, states, file=file, recent=self.recent
        )

    def reduced(
        self, groups: Sequence[int], rows: Int[np.ndarray, " sensor"]
    ) -> "StudyMatrices":
        """Return matrices of some groups and sensors, without error components."""
        if self.most_sensors is not None and len(rows) > self.most_sensors:
            raise InputError(
                f"a control rule requires {len(rows):,} sensors at a time, but only"
                f" {self.most_sensors:,} fit into memory_gb; a smaller grid or a larger"
                " memory_gb expected"
            )

        def some(chain: MatrixChain | None) -> MatrixChain | None:
            return chain and chain.without_errors(rows)

        parts = (self.windows[number] for number in groups)
        windows = tuple(
            WindowMatrices(some(part.whole), some(part.direct), some(part.sun))
            for part in parts
        )
        return StudyMatrices(self.terms, windows, self.suns)
