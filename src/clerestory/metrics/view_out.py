"""View out of EN 17037:2018: width, distance and layers, by rays through openings.

From every position at eye height, rays are cast through a grid of points of each
opening. The width of the view is the horizontal angle of the columns of that grid
through which outdoors is seen. The distance of a column is measured perpendicular to
the opening, to the farthest surface that is seen there and is not ground; that of the
view is reached in half of its width. Layers are sky, landscape (surfaces that are not
ground, and the open horizon) and ground. Beyond the scene the ground is a plane.

Reference: EN 17037:2018, 5.3 and table A.5.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from jaxtyping import Float, Int

from clerestory.directions import unit
from clerestory.metrics.spatial_metrics import area_share
from clerestory.scene.inside import inside_polygon

# Table A.5: limits of the levels minimum, medium and high; the three criteria are
# met at least at this share of the positions
WIDTHS_DEG = (14.0, 28.0, 54.0)
DISTANCES = (6.0, 20.0, 50.0)
LAYERS = (1, 2, 3)
AREA = 0.75

# Height of the eye of a seated person above the floor [m]
EYE_HEIGHT = 1.2

SKY, LANDSCAPE, GROUND = 1, 2, 4
LAYER_NAMES = {SKY: "sky", LANDSCAPE: "landscape", GROUND: "ground"}

# Grid of points of an opening
_COLUMNS, _ROWS = 64, 32

# Surfaces nearer to the opening belong to the façade and block the view [m]
_FACADE = 0.5

# Normals of ground surfaces and of roof windows; roof windows give no view
_UPWARD = 0.7

# Rays cast at a time
_MOST_RAYS = 2_000_000

# Function from origins and unit directions of rays to the distance of the first
# surface [m], inf if there is none, and to its unit normal
Cast = Callable[[np.ndarray, np.ndarray], tuple[np.ndarray, np.ndarray]]


@dataclass(frozen=True, eq=False)
class Opening:
    """A view opening: corners of a planar polygon [m], and the normal into the room."""

    corners: Float[np.ndarray, "corner 3"]
    normal: Float[np.ndarray, "3"]


class ViewOut(NamedTuple):
    """View out of each position.

    `width_deg` is the horizontal sight angle [°], `distance` that of the view [m],
    `layers` the bits `SKY`, `LANDSCAPE` and `GROUND` of the best opening.
    """

    width_deg: Float[np.ndarray, " position"]
    distance: Float[np.ndarray, " position"]
    layers: Int[np.ndarray, " position"]

    def criteria(self) -> Int[np.ndarray, "3 position"]:
        """Levels 0…3 of width, distance and layers at each position."""
        counts = layer_level(self.layers)
        return np.stack(
            [
                np.digitize(self.width_deg + 1e-9, WIDTHS_DEG),
                np.digitize(self.distance + 1e-9, DISTANCES),
                np.where(self.width_deg > 0, counts, 0),
            ]
        )

    def levels(self) -> Int[np.ndarray, " position"]:
        """Level 0…3 of each position: the lowest of its three criteria."""
        return np.asarray(self.criteria().min(axis=0))


def layer_level(layers: Int[np.ndarray, " position"]) -> Int[np.ndarray, " position"]:
    """Level 0…3 by layers: landscape, landscape and one more layer, all layers.

    >>> layer_level(np.array([SKY, LANDSCAPE, LANDSCAPE | SKY, 7])).tolist()
    [0, 1, 2, 3]
    """
    count = sum((layers & bit > 0).astype(int) for bit in LAYER_NAMES)
    return np.asarray(np.where(layers & LANDSCAPE > 0, count, 0))


def room_level(
    levels: Int[np.ndarray, " position"],
    area: Float[np.ndarray, " position"] | None = None,
) -> int:
    """Return the level 0…3 that is reached at 75 % of the positions or their area.

    >>> room_level(np.array([3, 3, 3, 1])), room_level(np.array([3, 3, 1, 1]))
    (3, 1)
    """
    shares = [area_share(levels >= level, area) for level in (1, 2, 3)]
    return sum(share >= AREA - 1e-12 for share in shares)


def view_out(
    eyes: Float[np.ndarray, "position 3"], openings: Sequence[Opening], cast: Cast
) -> ViewOut:
    """Return width, distance and layers of the view from each position.

    `eyes` are positions at eye height [m]. `cast` returns the first surface along
    rays; the openings are not surfaces. Openings in roofs are left out.
    """
    upright = [each for each in openings if abs(each.normal[2]) < _UPWARD]
    parts = [_through(eyes, opening, cast) for opening in upright]
    if not parts:
        none = np.zeros(len(eyes))
        return ViewOut(none, none.copy(), none.astype(int))
    first, last, distance = (
        np.concatenate([part[k] for part in parts], axis=1) for k in range(3)
    )
    layers = np.stack([part[3] for part in parts])
    best = layer_level(layers.ravel()).reshape(layers.shape).argmax(axis=0)
    chosen = np.take_along_axis(layers, best[None], axis=0)[0]
    return ViewOut(
        np.degrees(_union(first, last)), _typical(distance, last - first), chosen
    )


def _through(eyes: np.ndarray, opening: Opening, cast: Cast) -> tuple[np.ndarray, ...]:
    # Azimuths of the two edges of each column (equal if nothing is seen), distance of
    # each column, and layers of each position
    found = [_block(part, opening, cast) for part in _blocks(eyes)]
    return tuple(np.concatenate(arrays) for arrays in zip(*found, strict=True))


def _blocks(eyes: np.ndarray) -> Iterator[np.ndarray]:
    size = max(_MOST_RAYS // (_COLUMNS * (_ROWS + 1)), 1)
    return (eyes[first : first + size] for first in range(0, len(eyes), size))


def _block(eyes: np.ndarray, opening: Opening, cast: Cast) -> tuple[np.ndarray, ...]:
    edges, points, within = _grid(eyes, opening)
    normal = opening.normal
    away = points - eyes[:, None, None]
    length = np.linalg.norm(away, axis=-1)
    ahead = (eyes - opening.corners[0]) @ normal > 1e-6
    within = within & ahead[:, None, None] & (length > 0)
    direction = away / np.maximum(length, 1e-12)[..., None]
    chosen = np.nonzero(within)
    reach, facing = cast(eyes[chosen[0]], direction[chosen])
    past = (reach - length[chosen]) * -(direction[chosen] @ normal)
    seen = past > _FACADE
    rising = direction[chosen][:, 2]
    kind = _layer(reach, facing, rising)

    # The last row is horizontal: without a surface, it shows the open horizon
    kind[np.isinf(reach) & (chosen[2] == _ROWS)] = LANDSCAPE
    shape = within.shape
    kinds, far = np.zeros(shape, dtype=int), np.full(shape, -1.0)
    kinds[chosen] = np.where(seen, kind, 0)
    far[chosen] = np.where(seen & (kind == LANDSCAPE), past, -1.0)
    visible = kinds.max(axis=2) > 0
    farthest = far.max(axis=2)
    distance = np.where(farthest < 0, np.inf, farthest)
    across = edges[:, :, :2] - eyes[:, None, :2]
    azimuth = np.arctan2(across[..., 1], across[..., 0])
    start, turn = azimuth[:, :-1], np.diff(azimuth, axis=1)
    turn = (turn + np.pi) % (2 * np.pi) - np.pi
    low = np.where(turn < 0, start + turn, start)
    layers = np.bitwise_or.reduce(kinds.reshape(len(eyes), -1), axis=1)
    return low, low + np.where(visible, abs(turn), 0), distance, layers


def _grid(
    eyes: np.ndarray, opening: Opening
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    # Edges of the columns (position, column + 1, 3), points (position, column, row, 3)
    # and whether they are inside; the last row is at the height of the eye
    across = unit(np.cross([0.0, 0.0, 1.0], opening.normal))
    slope = np.cross(opening.normal, across)
    flat = opening.corners @ np.stack([across, slope], axis=1)
    (left, low), (right, high) = flat.min(axis=0), flat.max(axis=0)
    plane = float(opening.corners[0] @ opening.normal) * opening.normal
    wide = np.linspace(left, right, _COLUMNS + 1)
    middle = (wide[:-1] + wide[1:]) / 2
    rows = low + (np.arange(_ROWS) + 0.5) / _ROWS * (high - low)
    level = (eyes[:, 2] - plane[2]) / slope[2]
    heights = np.concatenate(
        [np.broadcast_to(rows, (len(eyes), _ROWS)), level[:, None]], axis=1
    )
    shape = (len(eyes), _COLUMNS, _ROWS + 1)
    u = np.broadcast_to(middle[:, None], shape)
    v = np.broadcast_to(heights[:, None], shape)
    inside = inside_polygon(np.stack([u, v], axis=-1).reshape(-1, 2), flat)
    points = plane + u[..., None] * across + v[..., None] * slope
    ends = plane + wide[:, None] * across + (low + high) / 2 * slope
    edges = np.broadcast_to(ends, (len(eyes), *ends.shape))
    return edges, points, inside.reshape(shape)


def _layer(reach: np.ndarray, facing: np.ndarray, rising: np.ndarray) -> np.ndarray:
    # Layer that each ray meets
    level = (abs(facing[:, 2]) > _UPWARD) & (rising < 0)
    met = np.where(level, GROUND, LANDSCAPE)
    return np.where(np.isfinite(reach), met, np.where(rising > 0, SKY, GROUND))


def _union(first: np.ndarray, last: np.ndarray) -> np.ndarray:
    # Length of the union of angular intervals [rad], for each position
    turns = 2 * np.pi
    start = first % turns
    end = start + (last - first)
    # An interval beyond a full turn continues at zero
    beyond = np.maximum(end - turns, 0)
    low = np.concatenate([start, np.zeros_like(start)], axis=1)
    high = np.concatenate([np.minimum(end, turns), beyond], axis=1)
    order = np.argsort(low, axis=1)
    low, high = (np.take_along_axis(each, order, axis=1) for each in (low, high))
    reached = np.maximum.accumulate(high, axis=1)
    before = np.pad(reached, ((0, 0), (1, 0)))[:, :-1]
    return np.asarray(np.maximum(high - np.maximum(low, before), 0).sum(axis=1))


def _typical(distance: np.ndarray, weight: np.ndarray) -> np.ndarray:
    # Distance that is reached in half of the width, for each position; 0 without view
    order = np.argsort(-distance, axis=1)
    ranked, share = (np.take_along_axis(x, order, axis=1) for x in (distance, weight))
    sums = np.cumsum(share, axis=1)
    half = np.argmax(sums >= sums[:, -1:] / 2 - 1e-12, axis=1)
    found = np.take_along_axis(ranked, half[:, None], axis=1)[:, 0]
    return np.where(sums[:, -1] > 0, found, 0.0)
