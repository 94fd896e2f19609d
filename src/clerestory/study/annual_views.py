"""Annual glare of the views of a study, and images of selected time steps.

Images are computed and evaluated one at a time; only the images of selected time steps
are written to files.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import starmap
from pathlib import Path

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.bands import Bands
from clerestory.checks import require
from clerestory.errors import located
from clerestory.escaping import file_stems
from clerestory.files import make_folder
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.glare_view import glare_view
from clerestory.glare.sources import warn_if_coarse
from clerestory.glare.uncertainty import UncertainLuminance
from clerestory.image.camera import Camera
from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.phases.matrix_equation import Skies, States
from clerestory.phases.picture_series import UncertainPixels, block_steps
from clerestory.phases.pixel_blocks import PixelBlocks
from clerestory.progress import Progress
from clerestory.scene.view import View
from clerestory.study.config_tables import EVERY, ViewTable
from clerestory.study.control_inputs import GlareFunction
from clerestory.study.job import Display
from clerestory.study.luminaire_matrices import Lamps
from clerestory.study.view_matrices import ViewMatrices
from clerestory.threads import evaluated_meanwhile, linear_algebra_in_one_thread

PICTURE_FOLDER = "pictures"

# Minimum view angle for glare evaluation [°]: 180° less a tolerance of 1°
_EYE_DEG = 179.0


def study_views(
    views: Sequence[ViewMatrices],
    skies: Skies,
    states: States,
    *,
    lamps: Lamps,
    output: Float[np.ndarray, "zone time"],
    every_state: Sequence[States] = (),
    out: Path,
    display: Display,
) -> xr.Dataset:
    """Return glare indices of views and time steps; write the selected images.

    The variables `glare_…` (view, time) are NaN in dark time steps; views that are too
    narrow for glare are omitted. `output` is the dimming level 0…1 of each zone.
    `every_state` are further operations, such as all window groups in one state, whose
    DGP is the variable `glare_dgp_by_state` (view, shade_state, time).
    """
    times = skies.whole.times
    daylight = skies.whole.diffuse.max(axis=0) > 0
    steps = np.flatnonzero(daylight | (output > 0).any(axis=0))
    found = {}
    stems = file_stems(view.table.label for view in views)
    for view in views:
        label = view.table.label
        kept, seen = picture_steps(view, times, steps)
        if len(seen) == 0:
            continue
        light = _Lamps(lamps.views.get(label, ()), output, view.job.scene.bands)
        stem = out / PICTURE_FOLDER / stems[label]
        if kept:
            show = _counted(display(f"pictures of {label}"), len(kept))
            chosen = np.array(sorted(kept))
            pictures = view.pictures(states, skies, chosen)
            for done, (step, picture) in enumerate(pictures, start=1):
                _write(light.added(picture, step), stem, kept[step])
                show(done)
        if sees_glare(view.camera.view):
            show = _counted(display(f"glare in {label}"), len(seen))
            given = view.uncertain_luminance(states, skies, seen)
            series = starmap(light.uncertain, given)
            glare = _glare(series, view, times, seen, states, progress=show)
            if every_state:
                show = _counted(display(f"glare in {label} by state"), len(seen))
                glare["dgp_by_state"] = xr.concat(
                    [
                        _dgp(view, skies, each, seen, light, progress=show)
                        for each in every_state
                    ],
                    "shade_state",
                )
            found[label] = glare.reindex(time=times)
    if not found:
        return xr.Dataset()
    every = xr.concat(list(found.values()), dim="view").assign_coords(view=list(found))
    return every.rename({name: f"glare_{name}" for name in every.data_vars})


def _dgp(
    view: ViewMatrices,
    skies: Skies,
    states: States,
    steps: Int[np.ndarray, " step"],
    lamps: "_Lamps",
    *,
    progress: Callable[[int], None],
) -> xr.DataArray:
    # DGP of the steps without standard errors, with the electric light
    series = starmap(lamps.luminance, view.luminance(states, skies, steps))
    times = skies.whole.times
    return _glare(series, view, times, steps, states, progress=progress)["dgp"]


def picture_steps(
    view: ViewMatrices, times: np.ndarray, steps: Int[np.ndarray, " lit"]
) -> tuple[dict[int, str], Int[np.ndarray, " step"]]:
    """Return the time steps whose pictures are written, and those that are computed.

    `steps` are those with light. A picture that is written has its date and time.
    """
    kept = _asked_for(view.table, times, steps)
    every = sees_glare(view.camera.view)
    return kept, steps if every else np.array(sorted(kept), int)


def sees_glare(view: View) -> bool:
    """Whether a view is wide enough for the evaluation of glare."""
    wide = min(view.horizontal, view.vertical) >= _EYE_DEG
    return wide and view.kind in ("angular", "hemispherical")


def warn_of_views(views: Sequence[ViewTable], cameras: Sequence[Camera]) -> None:
    """Warn of views with too few pixels for the evaluation of glare."""
    for table, camera in zip(views, cameras, strict=True):
        if sees_glare(camera.view):
            name = f'[[view]] "{table.label}"'
            with located(file=None, subject=f"{name} resolution"):
                eye = glare_view(camera.view, camera.columns, camera.rows)
            warn_if_coarse(eye, SourceRules(), name=name)


def glare_function(
    views: Sequence[ViewMatrices], skies: Skies, *, display: Display
) -> GlareFunction:
    """Return a function that computes DGP due to daylight at given time steps.

    The function returns the largest DGP among the views, 0 in dark time steps.
    """
    times = skies.whole.times
    lit = skies.whole.diffuse.max(axis=0) > 0

    def largest_dgp(
        states: States, steps: Int[np.ndarray, " step"], names: Sequence[str]
    ) -> Float[np.ndarray, " step"]:
        worst = np.zeros(len(steps))
        bright = steps[lit[steps]]
        named = [view for view in views if view.table.label in names]
        eyes = [view for view in views if sees_glare(view.camera.view)]
        for view in named or eyes or views:
            require(
                sees_glare(view.camera.view),
                f'view "{view.table.label}" is too narrow for the evaluation of glare;'
                " an angular or hemispherical view of 180° expected",
                file=view.table.file,
            )
            if len(bright):
                series = view.luminance(states, skies, bright)
                pixels = (luminance for _, luminance in series)
                shown = display(f"glare in {view.table.label}")
                report = _counted(shown, len(bright))
                glare = _glare(pixels, view, times, bright, states, progress=report)
                seen = lit[steps]
                worst[seen] = np.maximum(worst[seen], glare["dgp"].values)
        return worst

    return largest_dgp


def _glare(
    series: Iterator[np.ndarray | UncertainLuminance],
    view: ViewMatrices,
    times: np.ndarray,
    steps: np.ndarray,
    states: States,
    *,
    progress: Callable[[int], None],
) -> xr.Dataset:
    # Images are grouped by combination of shade states, not in order of time
    order = view.order(states, steps)

    def evaluate(pictures: Iterator[np.ndarray | UncertainLuminance]) -> xr.Dataset:
        return annual_glare(
            pictures,
            view.camera.view,
            times=times[order],
            name=f'[[view]] "{view.table.label}"',
            check_pixels=False,
            progress=progress,
        )

    # Pictures are evaluated while the next block of them is computed
    most = block_steps(len(view.camera))
    with linear_algebra_in_one_thread():
        found = evaluated_meanwhile(evaluate, series, most=most)
    return found.sortby("time")


def _counted(progress: Progress, count: int) -> Callable[[int], None]:
    return lambda done: progress(done / count, f"{done} of {count} steps")


def _asked_for(
    table: ViewTable, times: np.ndarray, steps: np.ndarray
) -> dict[int, str]:
    # Date and time of each selected picture, as given in the study, by time-step index
    names = np.datetime_as_string(times[steps], unit="m").tolist()
    stamps = {name[5:]: int(step) for name, step in zip(names, steps, strict=True)}
    wanted = list(stamps) if EVERY in table.pictures else table.pictures
    for moment in wanted:
        require(
            moment in stamps,
            f'view "{table.label}": no step with light at {moment}; a moment such as'
            f" {[*stamps, 'none'][len(stamps) // 2]} expected",
        )
    return {stamps[moment]: moment for moment in wanted}


@dataclass(frozen=True, eq=False)
class _Lamps:
    # Radiance (pixel, channel) due to each lighting zone at full output, and the
    # dimming level 0…1 of each zone
    zones: Sequence[np.ndarray]
    output: Float[np.ndarray, "zone time"]
    bands: Bands

    def _at(self, step: int) -> Iterator[tuple[int, np.float32]]:
        for number in range(len(self.zones)):
            if self.output[number, step] > 0:
                yield number, np.float32(self.output[number, step])

    def added(self, picture: Picture, step: int) -> Picture:
        """Add the electric light at a time step to a picture."""
        pixels = picture.radiance
        for number, share in self._at(step):
            pixels = pixels + share * self.zones[number].reshape(pixels.shape)
        return replace(picture, radiance=pixels)

    def luminance(self, step: int, luminance: np.ndarray) -> np.ndarray:
        """Add the electric light at a time step to the luminance of pixels."""
        for number, share in self._at(step):
            lit = share * self.bands.photometric(self.zones[number])
            luminance = luminance + lit.reshape(luminance.shape)
        return luminance

    def uncertain(self, step: int, given: UncertainPixels) -> UncertainLuminance:
        """Add the electric light to the luminance of pixels with errors."""
        luminance, blocks = self.luminance(step, given.luminance), given.blocks
        for number, share in self._at(step):
            lit = share * self.bands.photometric(self.zones[number])
            few = PixelBlocks.of(*luminance.shape).means(lit.reshape(-1, 1))
            blocks = blocks + few.reshape(blocks.shape)
        return UncertainLuminance(luminance, given.error, given.shared, blocks)


def _write(picture: Picture, stem: Path, moment: str) -> None:
    make_folder(stem.parent)
    name = f"{stem.name}_{moment.replace(':', '')}.hdr"
    write_picture(picture, stem.parent / name)
