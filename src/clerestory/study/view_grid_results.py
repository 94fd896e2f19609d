"""Annual glare of view grids as labelled arrays, for results.nc.

A *grid view* is one direction at one position of a view grid. The views of all grids
are on one axis: by grid, position and azimuth.
"""

import itertools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float, Int

from clerestory.brief_repr import brief
from clerestory.escaping import file_stems
from clerestory.glare.comfort_classes import LIMITS
from clerestory.glare.view_grid_metrics import (
    ViewFigures,
    disturbed_positions,
    disturbed_views,
)
from clerestory.study.results import VIEWS
from clerestory.study.view_grid_positions import ViewGrid

_EXCEEDED, _SHARE = "grid_view_exceeded_dgp", "grid_view_glare_share"


@dataclass(frozen=True, eq=False)
class GridFigures:
    """Annual figures of all grid views: in the operation of the run, then by state.

    See `ViewFigures`; values of views that are not computed are NaN.
    """

    exceeded: Float[np.ndarray, "case view"]
    exceeded_error: Float[np.ndarray, "case view"]
    share: Float[np.ndarray, "case view limit"]
    share_error: Float[np.ndarray, "case view limit"]

    __repr__ = brief

    @classmethod
    def blank(cls, cases: int, views: int) -> "GridFigures":
        """Return figures that are all NaN."""
        shapes = [(cases, views)] * 2 + [(cases, views, len(LIMITS))] * 2
        return cls(*(np.full(shape, np.nan, np.float32) for shape in shapes))

    def put(self, case: int, views: slice, figures: ViewFigures) -> None:
        """Fill in the figures of some views."""
        for name, values in vars(figures).items():
            getattr(self, name)[case, views] = values

    def variables(self) -> dict[str, xr.DataArray]:
        """Return the figures as variables of results.nc."""
        found = {}
        for name, values, axes in (
            (_EXCEEDED, self.exceeded, ()),
            (f"{_EXCEEDED}_error", self.exceeded_error, ()),
            (_SHARE, self.share, ("dgp_limit",)),
            (f"{_SHARE}_error", self.share_error, ("dgp_limit",)),
        ):
            found[name] = xr.DataArray(values[0], dims=(VIEWS, *axes))
            if len(values) > 1:
                every = xr.DataArray(values[1:], dims=("shade_state", VIEWS, *axes))
                found[f"{name}_by_state"] = every
        return found | {"dgp_limit": xr.DataArray(list(LIMITS), dims="dgp_limit")}


def grid_rows(grids: Sequence[ViewGrid]) -> list[slice]:
    """Return the views of each grid, as a part of the axis of all views."""
    ends = np.cumsum([0, *(len(grid) * grid.table.directions for grid in grids)])
    return [slice(*pair) for pair in itertools.pairwise(ends.tolist())]


def grid_labels(grids: Sequence[ViewGrid]) -> dict[str, Any]:
    """Return name, grid, position, azimuth and index of the position of each view."""
    counts = [len(grid) * grid.table.directions for grid in grids]
    number = [np.repeat(np.arange(len(g)), g.table.directions) for g in grids]
    azimuth = np.concatenate([np.tile(g.azimuths_deg, len(g)) for g in grids])
    names = [
        f"{grid.name}.{at + 1}.{turn:g}"
        for grid in grids
        for at in range(len(grid))
        for turn in grid.azimuths_deg.tolist()
    ]
    place = [grid.position[own] for grid, own in zip(grids, number, strict=True)]
    owner = np.repeat([grid.name for grid in grids], counts)
    return {
        VIEWS: xr.DataArray(np.array(names), dims=VIEWS),
        "view_grid": xr.DataArray(owner, dims=VIEWS),
        "grid_view_position": xr.DataArray(
            np.concatenate(place), dims=(VIEWS, "xyz"), attrs={"units": "m"}
        ),
        "grid_view_azimuth": xr.DataArray(
            azimuth, dims=VIEWS, attrs={"units": "degree"}
        ),
        "grid_view_number": xr.DataArray(np.concatenate(number), dims=VIEWS),
    }


def picture_stems(views: Sequence[str], grids: Sequence[str]) -> dict[str, str]:
    """Return the stem of the picture file of each grid, beside those of views."""
    stems = list(file_stems([*views, *(f"{grid} worst" for grid in grids)]).values())
    return dict(zip(grids, stems[len(stems) - len(grids) :], strict=True))


class WorstMoment(NamedTuple):
    """Moment of the highest DGP of a view grid in the occupied time.

    `view` is the index of the view on the axis of all views, `step` that of the time
    step; both are -1 if all occupied steps are dark.
    """

    dgp: float = 0.0
    error: float = 0.0
    view: int = -1
    step: int = -1

    def among(
        self,
        dgp: Float[np.ndarray, "view step"],
        error: Float[np.ndarray, "view step"],
        *,
        first: int,
        steps: Int[np.ndarray, " step"],
    ) -> "WorstMoment":
        """Return this moment or a worse one of more views, the first of them `first`.

        `steps` are the indices of the time steps of the values.
        """
        if not dgp.size or float(dgp.max()) <= self.dgp:
            return self
        view, step = divmod(int(dgp.argmax()), dgp.shape[1])
        own = float(dgp[view, step]), float(error[view, step])
        return WorstMoment(*own, first + view, int(steps[step]))


def worst_moments(moments: Sequence[WorstMoment]) -> dict[str, xr.DataArray]:
    """Return the worst moment of each grid as variables of results.nc."""
    names = ("worst_dgp", "worst_dgp_error", "worst_view", "worst_step")
    columns = zip(*moments, strict=True)
    return {
        name: xr.DataArray(np.array(column), dims="view_grid_name")
        for name, column in zip(names, columns, strict=True)
    }


def disturbed_shares(
    grids: Sequence[ViewGrid], figures: GridFigures
) -> dict[str, xr.DataArray]:
    """Return the shares of views and positions of each grid with disturbing glare."""
    rows = []
    for grid, own in zip(grids, grid_rows(grids), strict=True):
        dgp, error = (
            values[0, own].astype(float)
            for values in (figures.exceeded, figures.exceeded_error)
        )
        place = np.repeat(np.arange(len(grid)), grid.table.directions)
        rows.append(
            (
                *disturbed_views(dgp, error, position=place),
                *disturbed_positions(dgp, error, position=place),
            )
        )
    names = ("disturbed_views", "disturbed_positions")
    every = [part for name in names for part in (name, f"{name}_error")]
    found = {
        name: xr.DataArray(np.array(column), dims="view_grid_name")
        for name, column in zip(every, zip(*rows, strict=True), strict=True)
    }
    labels = [grid.name for grid in grids]
    return found | {"view_grid_name": xr.DataArray(labels, dims="view_grid_name")}
