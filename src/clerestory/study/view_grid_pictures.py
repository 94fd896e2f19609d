"""Picture of the worst moment of each view grid: view and hour of the highest DGP."""

from collections.abc import Sequence
from pathlib import Path

import numpy as np
import xarray as xr

from clerestory.files import make_folder
from clerestory.image.camera import Camera
from clerestory.image.picture_files import write_picture
from clerestory.phases.matrix_equation import Skies, States
from clerestory.study.config_tables import ViewTable
from clerestory.study.job import Job
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.view_grid_results import picture_stems
from clerestory.study.view_matrices import trace_view

# Paths per pixel
_SAMPLES = 256


def write_worst_pictures(
    job: Job,
    matrices: StudyMatrices,
    skies: Skies,
    states: States,
    *,
    found: xr.Dataset,
    folder: Path,
) -> None:
    """Write the worst moment of each view grid, in daylight, as a picture.

    `found` is the annual glare of the view grids. A grid without an occupied step in
    daylight, or whose pictures have no pixels, has no picture.
    """
    for number, (file, camera) in enumerate(_cameras(job, found)):
        if camera is None:
            continue
        step = int(found["worst_step"][number])
        table = ViewTable.model_construct(
            None, file=Path(), name=file, samples=_SAMPLES
        )
        view = trace_view(job, matrices, table, camera)
        for _, picture in view.pictures(states, skies, np.array([step])):
            stamp = str(skies.times[step].astype("datetime64[m]"))[5:].replace(":", "")
            write_picture(picture, make_folder(folder) / f"{file}_{stamp}.hdr")


def _cameras(job: Job, found: xr.Dataset) -> Sequence[tuple[str, Camera | None]]:
    # Name of the picture file and camera of each view grid
    grids = job.inputs.view_grids
    labels = [table.label for table in job.study.view]
    stems = picture_stems(labels, [grid.name for grid in grids])
    cameras: list[tuple[str, Camera | None]] = []
    for number, grid in enumerate(grids):
        view, size = int(found["worst_view"][number]), grid.table.picture_resolution
        if view < 0 or not size:
            cameras.append((stems[grid.name], None))
            continue
        owner = found["view_grid"].values
        first = int(np.flatnonzero(owner == grid.name)[0])
        at, towards = divmod(view - first, grid.table.directions)
        cameras.append((stems[grid.name], Camera(grid.views(at)[towards], size, size)))
    return cameras
