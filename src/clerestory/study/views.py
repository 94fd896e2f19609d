"""Pictures of a study: glare at every step, and the pictures asked for.

Pictures come one after the other and are judged at once; only those asked for by
name are written.
"""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import xarray as xr

from clerestory.errors import InputError
from clerestory.files import make_folder
from clerestory.glare.annual import annual_glare
from clerestory.image.picture import Picture
from clerestory.image.write import write_picture
from clerestory.phases.pictures import (
    Camera,
    PicturePhases,
    Progress,
    pictures_over_time,
    sun_pictures,
)
from clerestory.phases.three import WindowPhases
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.tables import EVERY, ViewTable
from clerestory.study.tracing import Display, Job, Skies, Tracing, picture_views

PICTURE_FOLDER = "pictures"


def study_views(
    study: Study,
    inputs: Inputs,
    tracing: Tracing,
    skies: Skies,
    *,
    job: Job,
    out: Path,
    display: Display,
) -> xr.Dataset:
    """Return the glare of every view at every step, and write the pictures asked for.

    Steps without light have no glare: NaN.

    Returns
    -------
    variables `glare_…` over (view, time), such as `glare_dgp` and `glare_illuminance`,
    the vertical illuminance at the eye [lux]
    """
    found = []
    for table, camera in zip(study.view, inputs.cameras, strict=True):
        lit = skies.whole.diffuse.max(axis=0) > 0
        times = skies.whole.times[lit]
        windows = _phases(job, inputs, tracing, camera, table.label)
        suns = None if tracing.suns is None else tracing.suns.select(lit)
        series = pictures_over_time(
            windows,
            camera,
            skies.whole.select(lit),
            sun_in_patches=None if skies.sun is None else skies.sun.select(lit),
            suns=suns,
        )
        kept = _asked_for(table, times)
        show = _counted(display(f"pictures of {table.label}"), len(times))
        luminance = _written(series, kept, out / PICTURE_FOLDER, table.label)
        glare = annual_glare(
            luminance,
            camera.view,
            times=times,
            progress=show,
        )
        found.append(glare.reindex(time=skies.whole.times))
    if not found:
        return xr.Dataset()
    names = [table.label for table in study.view]
    every = xr.concat(found, dim="view").assign_coords(view=names)
    return every.rename({name: f"glare_{name}" for name in every.data_vars})


def _phases(
    job: Job, inputs: Inputs, tracing: Tracing, camera: Camera, label: str
) -> list[PicturePhases]:
    whole, direct = picture_views(job, camera, label)
    windows = [group.inner for group in inputs.groups]
    parts = []
    for number, group in enumerate(inputs.groups):
        daylight = tracing.windows[number].daylight
        seen = WindowPhases(whole[group.name], group.states[0].transmission, daylight)
        if direct is None or tracing.suns is None:
            parts.append(PicturePhases(seen))
            continue
        black = tracing.direct[number].direct.daylight
        sun = sun_pictures(
            inputs.scene,
            windows,
            group.name,
            group.states[0].fine,
            camera,
            suns=tracing.suns.directions,
            peak=group.states[0].peak,
            samples=job.study.sun.picture_samples,
            seed=job.study.trace.seed,
            device=job.study.trace.device,
        )
        shown = WindowPhases(direct[group.name], group.states[0].transmission, black)
        parts.append(PicturePhases(seen, shown, sun))
    return parts


def _counted(progress: Progress, count: int) -> Callable[[int], None]:
    return lambda done: progress(done / count, f"{done} of {count} steps")


def _asked_for(table: ViewTable, times: np.ndarray) -> dict[int, str]:
    # Number of the step of each picture, and the words of the study for it
    found = {}
    stamps = np.datetime_as_string(times, unit="m")
    if EVERY in table.pictures:
        return {step: stamp[5:] for step, stamp in enumerate(stamps)}
    for moment in table.pictures:
        steps = [i for i, stamp in enumerate(stamps) if stamp[5:] == moment]
        if not steps:
            raise InputError(
                f'view "{table.label}": no step with light at {moment}; one such as'
                f" {stamps[len(stamps) // 2][5:]} expected"
            )
        found[steps[0]] = moment
    return found


def _written(
    series: Iterator[Picture], kept: dict[int, str], folder: Path, label: str
) -> Iterator[np.ndarray]:
    for step, picture in enumerate(series):
        if step in kept:
            make_folder(folder)
            name = f"{label}_{kept[step].replace(':', '')}.hdr"
            write_picture(picture, folder / name)
        yield picture.luminance()
