"""Product of recorded paths to a window and tables of its radiance in sunlight.

    C_ds S_sun:  Σ weight × radiance (cell, step) × transmittance (zone, step)

The sum is over the contributions of each receiver. Eight time steps share one lane, as
two vectors of four.
"""

from collections.abc import Callable, Sequence

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float, Float32, UInt32

from clerestory.engine.upload import launching, on_device
from clerestory.engine.window_path_jobs import Records
from clerestory.scene.window_zones import STRAIGHT

# Number of vectors of four time steps in a lane, and of time steps
_VECTORS = 2
_TOGETHER = 4 * _VECTORS

# Number of bits of the cell in a code; the others are those of the zone
_CELL_BITS = 20

# Function from recorded exit directions to cells
CellOf = Callable[
    [UInt32[np.ndarray, " contribution"]], UInt32[np.ndarray, " contribution"]
]


class PathProduct:
    """Recorded paths from receivers to one window.

    Parameters
    ----------
    records : contributions of each batch of paths
    zones : zones of the window
    cell_of : function from exit directions to cells of the window's BSDF
    cells : number of cells of the BSDF
    """

    def __init__(
        self,
        records: Sequence[Records],
        zones: slice,
        cell_of: CellOf,
        cells: int,
    ):
        parts = [_of_window(each, zones, cell_of, cells) for each in records]
        starts, codes, weights = zip(*parts, strict=True)
        # The receivers of all batches follow each other
        counts = np.concatenate([np.diff(each) for each in starts])
        edges = np.concatenate([[0], np.cumsum(counts)])
        self.rows = len(counts)
        self._starts = on_device(mi.UInt32, edges)
        self._codes = on_device(mi.UInt32, np.concatenate(codes))
        self._weights = np.concatenate(weights, axis=1)
        self._shares: dict[bytes, mi.Float] = {}

    def received(
        self,
        share: Float[np.ndarray, " channel"],
        radiance: Float32[np.ndarray, "twice step"],
        transmittance: Float32[np.ndarray, "zone step"],
    ) -> mi.Float:
        """Return Σ share × weight × radiance × transmittance.

        The sums are those of each batch, receiver and step.

        `radiance` has the cells for reflected light, then those for light that is seen
        directly. `share` weights the channels of the paths. The number of steps is that
        of `padded`; the result is on the compute device.
        """
        key = share.tobytes()
        if key not in self._shares:
            self._shares[key] = on_device(mi.Float, share.astype("f4") @ self._weights)
        steps = radiance.shape[1] // _TOGETHER
        same = bool((transmittance == transmittance[:1]).all())
        if same:
            radiance = radiance * transmittance[0]
        with launching():
            result = dr.empty(mi.Float, self.rows * radiance.shape[1])
            light = on_device(mi.Float, radiance)
            passed = None if same else on_device(mi.Float, transmittance)
            _sum(
                self.rows * steps, dr.opaque(mi.UInt32, steps), self._starts,
                self._codes, self._shares[key], light, passed, result,
            )  # fmt: skip
            dr.eval(result)
        return result


def padded(steps: int) -> int:
    """Return the number of steps for which `PathProduct.received` has room."""
    return -(-steps // _TOGETHER) * _TOGETHER


@dr.syntax
def _sum(lanes, steps, starts, codes, weights, radiance, transmittance, result):
    lane = dr.arange(mi.UInt32, lanes)
    row, step = lane // steps, lane % steps
    index = dr.gather(mi.UInt32, starts, row)
    end = dr.gather(mi.UInt32, starts, row + 1)
    total = _vectors()
    while index < end:
        code = dr.gather(mi.UInt32, codes, index)
        weight = dr.gather(mi.Float, weights, index)
        cell = (code & ((1 << _CELL_BITS) - 1)) * steps + step
        zone = (code >> _CELL_BITS) * steps + step
        total = _increased(total, weight, radiance, cell, transmittance, zone)
        index += 1
    _store(total, result, lane)


def _vectors() -> list[mi.Vector4f]:
    return [mi.Vector4f(0) for _ in range(_VECTORS)]


def _increased(total, weight, radiance, cell, transmittance, zone):
    # Sums, increased by a contribution; without transmittance, it is in the radiance
    found = []
    for number, before in enumerate(total):
        light = dr.gather(mi.Vector4f, radiance, cell * _VECTORS + number)
        if transmittance is not None:
            place = zone * _VECTORS + number
            light *= dr.gather(mi.Vector4f, transmittance, place)
        found.append(before + weight * light)
    return found


def _store(total, result, lane) -> None:
    for number, value in enumerate(total):
        place = lane * _VECTORS + number
        dr.scatter(result, value, place, mode=dr.ReduceMode.Permute)


def _of_window(
    records: Records, zones: slice, cell_of: CellOf, cells: int
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    # Contributions of one window: first of each receiver, zone and cell, and weights
    zone = records.zones & np.uint16(STRAIGHT - 1)
    own = (zone >= zones.start) & (zone < zones.stop)
    starts, weights, straight = (
        records.starts,
        records.weights,
        records.zones >= STRAIGHT,
    )
    directions = records.directions
    if not own.all():
        starts = np.concatenate([[0], np.cumsum(own)])[starts]
        zone, straight = zone[own], straight[own]
        directions, weights = directions[own], weights[:, own]
    place = cell_of(directions) + np.uint32(cells) * straight
    code = (zone.astype(np.uint32) - np.uint32(zones.start)) << np.uint32(_CELL_BITS)
    return starts, code | place, weights
