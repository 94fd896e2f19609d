"""Annual glare of the view grids in the results of a run, by position and direction."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.glare.comfort_classes import protection_level
from clerestory.glare.view_grid_metrics import Uncertain
from clerestory.report.period import evenly
from clerestory.report.uncertain_value import Figure

# Largest number of views of a grid on a page
_MOST_VIEWS = 4000

# Standard error of a share below which it is not shown
_LEAST = 5e-4

_COMPASS = ("north", "east", "south", "west")


class Worst(NamedTuple):
    """Moment of the highest DGP: index of the step, azimuth [°], place in words."""

    dgp: float
    error: float
    step: int
    azimuth: float
    place: str


@dataclass(frozen=True, eq=False)
class GridYear:
    """A year of glare at the positions of a view grid.

    Attributes
    ----------
    name : name of the grid
    number : number of each position in the grid, from 1
    position : positions of the eyes [m]
    azimuth : view directions, clockwise from the scene's +y [°]
    dgp, error : DGP and its standard error; NaN in the dark
    exceeded, exceeded_error : DGP exceeded in 5 % of the occupied time
    share, share_error : shares of the occupied time with DGP above 0.35, 0.40 and 0.45
    by_state : DGP exceeded in 5 % of the occupied time in each shade state
    disturbed : shares of all views, and of positions, of the grid with disturbing glare
        in more than 5 % of the occupied time
    worst_moment : moment of the highest DGP in the occupied time; None in the dark
    total : number of positions of the grid, of which a page shows some
    """

    name: str
    number: np.ndarray
    position: Float[np.ndarray, "position 3"]
    azimuth: Float[np.ndarray, " direction"]
    dgp: Float[np.ndarray, "position direction time"]
    error: Float[np.ndarray, "position direction time"]
    exceeded: Float[np.ndarray, "position direction"]
    exceeded_error: Float[np.ndarray, "position direction"]
    share: Float[np.ndarray, "position direction limit"]
    share_error: Float[np.ndarray, "position direction limit"]
    by_state: Float[np.ndarray, "state position direction"]
    disturbed: tuple[Uncertain, ...]
    worst_moment: "Worst | None"
    total: int

    __repr__ = brief

    @property
    def shape(self) -> tuple[int, int]:
        """Numbers of positions and directions."""
        return len(self.number), len(self.azimuth)

    @property
    def worst(self) -> tuple[int, int]:
        """Position and direction of the view with most glare in the occupied time."""
        # The highest share decides where several views have the same DGP
        order = np.lexsort((self.share[..., 1].ravel(), self.exceeded.ravel()))
        position, direction = divmod(int(order[-1]), len(self.azimuth))
        return position, direction

    def words(self, position: int, direction: int) -> str:
        """Return the annual glare of a view in words."""
        at = position, direction
        top = float(self.exceeded[at])
        level = protection_level(top)
        return (
            f"DGP {uncertain_dgp(top, float(self.exceeded_error[at]))} is exceeded in"
            f" 5 % of the occupied hours: {'no' if level == 'none' else level}"
            f" protection from glare after EN 17037; glare is disturbing in"
            f" {percent(self.share[at][1], self.share_error[at][1])} of them."
        )

    def place_words(self, position: int) -> str:
        """Return number and coordinates of a position."""
        return _place(int(self.number[position]), self.position[position])


def uncertain_dgp(value: float, error: float) -> str:
    """Return DGP with its standard error.

    >>> uncertain_dgp(0.4123, 0.012), uncertain_dgp(0.41, 0.0)
    ('0.41 ± 0.01', '0.41')
    """
    if error < 5e-4:
        return f"{value:.2f}"
    digits = 2 if error >= 0.005 else 3
    return f"{value:.{digits}f} ± {error:.{digits}f}"


def percent(share: float, error: float) -> str:
    """Return a fraction and its standard error as text, in per cent.

    >>> percent(0.123, 0.02), percent(0.123, 1e-6)
    ('12 ± 2 %', '12.3 %')
    """
    shown = error if error >= _LEAST else 0.0
    return str(Figure(100 * float(share), 100 * float(shown), "%"))


def direction_words(azimuth: float, *, north: float) -> str:
    """Return a view direction in words; `north` is the azimuth of the scene's +y [rad].

    >>> direction_words(135.0, north=0.0), direction_words(10.0, north=np.pi / 2)
    ('south-east, 135°', '100°')
    """
    turn = (azimuth + np.degrees(north)) % 360
    quarter, rest = divmod(round(turn, 6), 90)
    near, after = _COMPASS[int(quarter) % 4], _COMPASS[int(quarter + 1) % 4]
    if rest == 0:
        return f"{near}, {turn:g}°"
    if rest == 90 / 2:
        upright = near if near in ("north", "south") else after
        aside = after if upright == near else near
        return f"{upright}-{aside}, {turn:g}°"
    return f"{turn:g}°"


def grid_years(data: xr.Dataset) -> tuple[GridYear, ...]:
    """Return the year of each view grid in the results; empty without view grids."""
    if "grid_view_dgp" not in data:
        return ()
    names = list(dict.fromkeys(data["view_grid"].values.tolist()))
    return tuple(_year(data, name) for name in names)


def _year(data: xr.Dataset, name: str) -> GridYear:
    own = np.flatnonzero(data["view_grid"].values == name)
    part = data.isel(grid_view=slice(own[0], own[-1] + 1))
    count = len(np.unique(part["grid_view_number"].values))
    directions = len(own) // count
    chosen = np.array(evenly(count, max(1, _MOST_VIEWS // directions)))

    views = (chosen[:, None] * directions + np.arange(directions)).ravel()
    part = part.isel(grid_view=views)

    def values(variable: str) -> np.ndarray:
        axes = ("grid_view", *(a for a in data[variable].dims if a != "grid_view"))
        found = part[variable].transpose(*axes).values
        return np.asarray(found.reshape(len(chosen), directions, *found.shape[1:]))

    every = "grid_view_exceeded_dgp_by_state"
    none = np.zeros((0, len(chosen), directions))
    row = data.isel(view_grid_name=data["view_grid_name"].values.tolist().index(name))
    shares = (
        Uncertain(float(row[f"disturbed_{of}"]), float(row[f"disturbed_{of}_error"]))
        for of in ("views", "positions")
    )
    return GridYear(
        name=name,
        number=chosen + 1,
        position=values("grid_view_position")[:, 0],
        azimuth=values("grid_view_azimuth")[0],
        dgp=values("grid_view_dgp"),
        error=values("grid_view_dgp_error"),
        exceeded=values("grid_view_exceeded_dgp"),
        exceeded_error=values("grid_view_exceeded_dgp_error"),
        share=values("grid_view_glare_share"),
        share_error=values("grid_view_glare_share_error"),
        by_state=np.moveaxis(values(every), -1, 0) if every in data else none,
        disturbed=tuple(shares),
        worst_moment=_worst(data, row),
        total=count,
    )


def _worst(data: xr.Dataset, row: xr.Dataset) -> Worst | None:
    view, step = int(row["worst_view"]), int(row["worst_step"])
    if not (0 <= view < data.sizes["grid_view"] and 0 <= step < data.sizes["time"]):
        return None
    number = int(data["grid_view_number"][view]) + 1
    return Worst(
        float(row["worst_dgp"]),
        float(row["worst_dgp_error"]),
        step,
        float(data["grid_view_azimuth"][view]),
        _place(number, data["grid_view_position"].values[view]),
    )


def _place(number: int, position: Float[np.ndarray, "3"]) -> str:
    x, y, z = position.tolist()
    return f"{number} (x {x:.2f}, y {y:.2f}, z {z:.2f} m)"
