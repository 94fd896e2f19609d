"""Matrices of a study, for its sensors, and their products with the sky."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from jaxtyping import Bool, Int

from clerestory.errors import InputError
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Part,
    Skies,
    States,
    Term,
    WindowMatrices,
)
from clerestory.progress import Progress
from clerestory.sky.sun_matrix import SunMatrix


@dataclass(frozen=True, eq=False)
class StudyMatrices:
    """Traced matrices of a study.

    Attributes
    ----------
    terms : of the study's method
    windows : matrices of each window group; for the two-phase method without windows,
        those of the whole scene
    suns : columns of the direct-sun matrices; None without direct correction
    folder : where hourly results lie, in place of memory, until the run is done
    most_sensors : that fit into memory together without errors, where view matrices lie
        in files; None where they are in memory
    """

    terms: tuple[Term, ...]
    windows: tuple[WindowMatrices, ...]
    suns: SunMatrix | None = None
    folder: Path | None = None
    most_sensors: int | None = None

    @property
    def has_direct(self) -> bool:
        """Whether direct light was traced."""
        return all(window.direct or window.sun for window in self.windows)

    def illuminance(
        self,
        skies: Skies,
        states: States,
        *,
        hours: Bool[np.ndarray, " time"] | None = None,
        progress: Progress | None = None,
    ) -> xr.Dataset:
        """Illuminance [lux] over (sensor, time), with its standard error.

        Parameters
        ----------
        hours : steps that count for the error components of the mean
        """
        return illuminance(
            self.windows,
            self.terms,
            skies,
            states,
            hours=hours,
            file=self.folder and self.folder / "illuminance.nc",
            progress=progress,
        )

    def direct_illuminance(self, skies: Skies, states: States) -> xr.DataArray:
        """Illuminance [lux] straight from the sun, over (sensor, time).

        The sun is at its place where C_ds is known, else spread over sky patches.

        Raises
        ------
        InputError : direct light was not traced
        """
        if not self.has_direct:
            raise InputError("direct light was not traced; direct phases expected")
        part: Part = "direct" if self.suns is None else "sun"
        term = Term("direct", part, sky="sun")
        file = self.folder and self.folder / "direct.nc"
        found = illuminance(self.windows, (term,), skies, states, file=file)
        return found["illuminance"]

    def reduced(
        self, groups: Sequence[int], rows: Int[np.ndarray, " sensor"]
    ) -> "StudyMatrices":
        """Return some window groups and sensors in memory, without errors.

        Raises
        ------
        InputError : more sensors than memory holds
        """
        if self.most_sensors is not None and len(rows) > self.most_sensors:
            raise InputError(
                f"a rule looks at {len(rows):,} sensors together, where memory holds"
                f" {self.most_sensors:,}; a smaller grid, or a larger memory_gb,"
                " expected"
            )

        def some(chain: MatrixChain | None) -> MatrixChain | None:
            return chain and chain.without_errors(rows)

        parts = (self.windows[number] for number in groups)
        windows = tuple(
            WindowMatrices(
                part.whole.without_errors(rows), some(part.direct), some(part.sun)
            )
            for part in parts
        )
        return StudyMatrices(self.terms, windows, self.suns)
