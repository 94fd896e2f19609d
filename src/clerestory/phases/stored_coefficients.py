"""Daylight coefficients and direct-sun coefficients larger than memory, in files.

They are stored like view matrices: in blocks of sensors, with four error components.
"""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Unpack

import numpy as np
from jaxtyping import Float

from clerestory.engine.controller import row_blocks
from clerestory.engine.effort import EffortKeywords
from clerestory.engine.matrix_jobs import CoefficientsJob
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sky_axis, sun_axis
from clerestory.phases.matrix_store import BlockMaker
from clerestory.phases.stored_views import (
    FEW,
    StoredColumns,
    StoredViews,
    traced_block,
)
from clerestory.phases.traced_matrices import matrix_effort, require_sensors
from clerestory.phases.unscattered_light import sun_job
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors

# Function that stores blocks of rows, such as `MatrixStore.blocks` with a given name
# and fingerprint
BlockStore = Callable[[Sequence[slice], BlockMaker], tuple[Path, ...]]


def store_coefficients(
    store: BlockStore,
    scene: Scene,
    *,
    sensors: Sensors,
    subdivision: int = 4,
    direct: bool = False,
    **keywords: Unpack[EffortKeywords],
) -> tuple[StoredColumns, ...]:
    """Trace C into files and return it; if `direct`, also C_d from the same paths.

    See `daylight_coefficients` and `separate_coefficients` for the parameters.
    """
    effort = replace(matrix_effort(store_coefficients, keywords), components=True)
    require_sensors(sensors, effort)
    sky = reinhart(subdivision)
    job = CoefficientsJob(
        scene=scene, sky=sky, sensors=sensors, separate=direct, **effort.job_options()
    )
    make = partial(
        traced_block,
        job,
        effort,
        what="daylight coefficients",
        arrange=_all_and_direct if direct else np.asarray,
    )
    rows = tuple(row_blocks(job))
    stored, axis = StoredViews(store(rows, make), rows), sky_axis(sky)
    return tuple(StoredColumns(stored, axis, n * axis.size) for n in range(1 + direct))


def store_sun(
    store: BlockStore,
    scene: Scene,
    *,
    sensors: Sensors,
    suns: Float[np.ndarray, "sun 3"],
    rows: Sequence[slice],
    **keywords: Unpack[EffortKeywords],
) -> StoredColumns:
    """Trace the direct-sun coefficients C_ds into files, in given blocks of rows.

    See `unscattered_sun` for the other parameters.
    """
    job, effort = sun_job(store_sun, scene, sensors, suns, keywords, batches=FEW)
    effort = replace(effort, components=True)
    make = partial(traced_block, job, effort, what="direct-sun coefficients")
    stored = StoredViews(store(rows, make), tuple(rows))
    return StoredColumns(stored, sun_axis(len(suns)), 0)


def _all_and_direct(columns: np.ndarray) -> np.ndarray:
    # Columns of all light and of direct light, from those of direct and other light
    direct, other = np.split(columns, 2, axis=-1)
    return np.concatenate([direct + other, direct], axis=-1)
