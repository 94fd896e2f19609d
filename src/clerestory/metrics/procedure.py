"""Requirements of the procedures of standards: hours, grids and weather.

Each check returns what was found in the results of a space, what is expected and, if a
requirement is not fulfilled, what to change in the study.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from clerestory.metrics.compliance import Check, Requirement, Status
from clerestory.metrics.space import Space

HOURS_A_YEAR = 8760

# Largest deviation of the height of a grid from that of the procedure [m]
_HEIGHT = 0.05

_LOWEST_UP = 0.999


def requirement(
    name: str, fulfilled: bool, found: str, *, expected: str, change: str
) -> Requirement:
    """Return a requirement that is fulfilled or not."""
    status: Status = "fulfilled" if fulfilled else "not fulfilled"
    return Requirement(name, status, found, expected, "" if fulfilled else change)


def unknown(name: str, found: str, *, expected: str, change: str) -> Requirement:
    """Return a requirement of which the results do not say whether it is fulfilled."""
    return Requirement(name, "not known", found, expected, change)


def confirmed_by_hand(name: str, *, expected: str) -> Check:
    """Return a check of what only the author of the model knows."""

    def check(space: Space) -> Iterator[Requirement]:
        change = "confirm this for the model"
        yield unknown(name, "not part of the results", expected=expected, change=change)

    return check


def whole_year(space: Space) -> Iterator[Requirement]:
    """Check that the results cover a year in steps of an hour or less."""
    step = space.step_hours
    days = len(space.data["time"]) * step / 24
    yield requirement(
        "Period",
        days * 24 >= HOURS_A_YEAR - 24,
        f"{days:.0f} days",
        expected="a whole year",
        change="remove from, to, from_hour, to_hour, every and moments of [weather]",
    )
    yield requirement(
        "Time step",
        step <= 1,
        f"time steps of {step:g} h",
        expected="1 h or less",
        change="use hourly weather, and every = 1 in [weather]",
    )


def typical_weather(space: Space) -> Iterator[Requirement]:
    """Check that the weather is that of a file for a typical year."""
    weather = space.study.get("weather") or {}
    name, expected = "Weather", "a weather file of a typical year"
    change = "name an EPW or TMY3 file of the site in [weather]"
    if weather.get("clear_sky"):
        found = "a year of clear skies"
        yield requirement(name, False, found, expected=expected, change=change)
    elif weather.get("measured") or str(weather.get("file", "")).endswith(".toml"):
        found = "measured weather"
        yield requirement(name, False, found, expected=expected, change=change)
    elif weather.get("file"):
        found = f"weather of {space.data.attrs.get('place') or weather['file']}"
        yield requirement(name, True, found, expected=expected, change=change)
    else:
        found = "unknown weather"
        yield unknown(name, found, expected=expected, change=change)


def grid_facing_up(space: Space) -> Iterator[Requirement]:
    """Check that the sensors face up."""
    if "direction" in space.data:
        level = space.data["direction"].values[:, 2].min() >= _LOWEST_UP
        yield requirement(
            "Direction of the sensors",
            bool(level),
            "sensors that face up" if level else "sensors that do not face up",
            expected="a horizontal grid",
            change="give the sensors of [[sensors]] the direction 0 0 1",
        )


def grid_height(height: float) -> Check:
    """Return a check of the height of the sensors above the floor [m]."""

    def check(space: Space) -> Iterator[Requirement]:
        name, expected = "Height of the grid", f"{height:.2f} m above the floor"
        change = f"place the sensors {height:.2f} m above the floor"
        if "height_above_floor" not in space.data:
            found = "unknown height of the floor"
            yield unknown(name, found, expected=expected, change=change)
            return
        above = space.data["height_above_floor"].values.astype(float)
        median = float(np.median(above))
        near = abs(median - height) <= _HEIGHT + 1e-6
        found = "sensors without a floor below them"
        if np.isfinite(median):
            found = f"sensors {median:.2f} m above the floor"
        yield requirement(name, near, found, expected=expected, change=change)

    return check


def grid_spacing_limit(largest: float, words: str) -> Check:
    """Return a check of the spacing of the sensors [m]."""

    def check(space: Space) -> Iterator[Requirement]:
        if "position" in space.data:
            spacing = grid_spacing(space.data["position"].values.astype(float))
            yield requirement(
                "Grid spacing",
                spacing <= largest,
                _spacing_words(spacing),
                expected=f"a grid of at most {words}",
                change=f"space the sensors of [[sensors]] at most {words} apart",
            )

    return check


def grid_spacing_en17037(space: Space) -> Iterator[Requirement]:
    """Check the spacing by EN 17037, annex B: at most p = 0.5 · 5^log₁₀ d.

    d is the longer side of the grid [m], or the shorter one if the longer is at least
    twice as long; the spacing is at most 10 m.
    """
    if "position" not in space.data:
        return
    places = space.data["position"].values.astype(float)
    spacing, sides = grid_spacing(places), np.sort(grid_sides(places))
    d = sides[0] if sides[1] >= 2 * sides[0] else sides[1]
    largest = min(0.5 * 5 ** np.log10(max(d, 1e-3)), 10.0)
    yield requirement(
        "Grid spacing",
        spacing <= largest * 1.01,
        _spacing_words(spacing),
        expected=f"a grid of at most {largest:.2f} m, for a side of {d:.1f} m",
        change=f"space the sensors of [[sensors]] at most {largest:.2f} m apart",
    )


def grid_spacing(position: Float[np.ndarray, "sensor 3"]) -> float:
    """Return the larger spacing of a grid of sensors in its two directions [m].

    The result is the median over the sensors, and infinite for a single sensor.

    >>> x, y = np.meshgrid(np.arange(4) * 0.5, np.arange(3) * 1.2)
    >>> float(grid_spacing(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)))
    1.2
    """
    return float(np.median(_spacings(position).max(axis=0)))


def cell_area(position: Float[np.ndarray, "sensor 3"]) -> float:
    """Return the area of a cell of a grid of sensors [m²]; 1 m² for a single sensor.

    >>> x, y = np.meshgrid(np.arange(4) * 0.5, np.arange(3) * 1.2)
    >>> round(cell_area(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3)), 9)
    0.6
    """
    area = float(np.median(_spacings(position).prod(axis=0)))
    return area if np.isfinite(area) else 1.0


def grid_sides(position: Float[np.ndarray, "sensor 3"]) -> Float[np.ndarray, "2"]:
    """Return the sides of the rectangle that a horizontal grid fills [m]."""
    spacing = _spacings(position)
    if not np.isfinite(spacing).all():
        return np.zeros(2)
    flat = position[:, :2] - position[0, :2]
    length = np.linalg.norm(flat, axis=1)
    near = flat[np.argmin(np.where(length > 1e-6, length, np.inf))]
    along = near / np.linalg.norm(near)
    turned = np.stack([flat @ along, flat @ np.array([-along[1], along[0]])])
    return np.asarray(np.ptp(turned, axis=1) + np.median(spacing, axis=1))


def _spacings(position: np.ndarray) -> np.ndarray:
    # Distance of the nearest neighbour of each sensor, and perpendicular distance of
    # the nearest one in another direction
    places = np.unique(position.round(4), axis=0)
    if len(places) < 2:
        return np.full((2, 1), np.inf)
    near = cKDTree(places).query(places, k=range(2, min(len(places), 26) + 1))[1]
    across = places[near] - places[:, None]
    length = np.linalg.norm(across, axis=2)
    nearest = across[:, 0] / length[:, :1]
    beside = np.linalg.norm(np.cross(across, nearest[:, None]), axis=2)

    # Neighbours in the other direction deviate from the nearest one's by 30° or more
    beside = np.where(beside >= 0.5 * length, beside, np.inf).min(axis=1)
    beside = np.where(np.isfinite(beside), beside, length[:, 0])
    return np.stack([length[:, 0], beside])


def _spacing_words(spacing: float) -> str:
    return f"a spacing of {spacing:.2f} m" if spacing < np.inf else "one sensor"
