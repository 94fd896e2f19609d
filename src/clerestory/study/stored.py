"""Studies larger than memory: view matrices and hourly results lie in files.

The light is that of `Tracing`, up to the rounding of single precision; its standard
error comes from four pooled batches in place of sixteen.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import xarray as xr
from jaxtyping import Int

from clerestory.errors import InputError
from clerestory.matrix.axis import sensor_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.shaded import ShadedWindow, States
from clerestory.phases.stored_views import StoredViews
from clerestory.phases.streamed import Opening, leaving_light, stream_illuminance
from clerestory.progress import Progress
from clerestory.sky.patch_radiance import SkyMatrix
from clerestory.study.job import Display
from clerestory.study.traced import Skies, Tracing


@dataclass(frozen=True, eq=False)
class StoredTracing:
    """Traced matrices of a study whose view matrices are larger than memory.

    Attributes
    ----------
    folder : for hourly results, until they are part of the results of the run
    most : how many sensors a rule may look at together
    views, whole : V of all windows; T and D of each
    direct_views, direct : V_d; T and D_d, where direct light is traced apart
    """

    folder: Path
    most: int
    views: StoredViews
    whole: tuple[Opening, ...]
    direct_views: StoredViews | None = None
    direct: tuple[Opening, ...] = ()

    @property
    def suns(self) -> None:
        """No suns: only the three-phase method streams."""

    def illuminance(
        self, skies: Skies, states: States, *, display: Display
    ) -> xr.Dataset:
        """Illuminance [lux] over (sensor, time), with its standard error, in a file."""
        file = self.folder / "illuminance.nc"
        return _streamed(
            file, self.views, self.whole, skies.whole, states, display("multiply")
        )

    def direct_illuminance(self, skies: Skies, states: States) -> xr.DataArray:
        """Illuminance [lux] of the sun, spread over patches of the sky, in a file.

        Raises
        ------
        InputError : direct light was not traced
        """
        if self.direct_views is None or skies.sun is None:
            raise InputError("direct light was not traced; direct phases expected")
        file = self.folder / "direct.nc"
        found = _streamed(
            file, self.direct_views, self.direct, skies.sun, states, _silent
        )
        return found["illuminance"]

    def reduced(
        self, groups: Sequence[int], rows: Int[np.ndarray, " sensor"]
    ) -> Tracing:
        """Return some window groups and sensors in memory, without errors.

        Raises
        ------
        InputError : more sensors than memory holds
        """
        if len(rows) > self.most:
            raise InputError(
                f"a rule looks at {len(rows):,} sensors together, where memory holds"
                f" {self.most:,}; a smaller grid, or a larger memory_gb, expected"
            )
        whole = _held(self.views, self.whole, groups, rows)
        if self.direct_views is None:
            return Tracing(whole=whole)
        return Tracing(
            whole=whole, direct=_held(self.direct_views, self.direct, groups, rows)
        )


# Matrices of a study in memory, or in files
Traced = Tracing | StoredTracing


def _silent(_share: float, _note: str) -> None:
    pass


def _streamed(
    file: Path,
    views: StoredViews,
    openings: Sequence[Opening],
    sky: SkyMatrix,
    states: States,
    progress: Progress,
) -> xr.Dataset:
    leaving = leaving_light(openings, sky, states, channels=views.channels())
    stream_illuminance(file, views, leaving, sky, progress=progress)
    # Values are read when they are asked for, and not kept
    stored = xr.open_dataset(file, engine="h5netcdf", cache=False)
    return stored.assign_coords(sensor=np.arange(views.sensors), time=sky.times)


def _held(
    views: StoredViews,
    openings: Sequence[Opening],
    groups: Sequence[int],
    rows: Int[np.ndarray, " sensor"],
) -> tuple[ShadedWindow, ...]:
    # Windows in memory, for some sensors
    every = views.of(rows)
    ends = np.cumsum([opening.transmissions[0].rows.size for opening in openings])
    sensors = sensor_axis(len(rows))
    found = []
    for number in groups:
        opening = openings[number]
        patches = opening.transmissions[0].rows
        part = every[:, :, ends[number] - patches.size : ends[number]]
        view = TransferMatrix(part, sensors, patches)
        found.append(ShadedWindow(view, opening.transmissions, opening.daylight))
    return tuple(found)
