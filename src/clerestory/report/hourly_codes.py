"""Hourly values quantised and compressed for a page that computes with them.

Illuminance is rounded to equal steps of log(1 + lux). The codes of neighbouring sensors
and hours differ little, so their differences are compressed. Chosen limits are exact:
a decoded value reaches them if and only if the illuminance does.
"""

import gzip
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float, Int, UInt16

from clerestory.brief_repr import brief
from clerestory.report.embedded_data import BRIGHTEST, illuminance_codes

# Step of log(1 + lux): the error of decoded values is at most this fraction of
# 1 lux + illuminance
STEP = 0.005

# Number of codes of illuminance
LEVELS = 1 + int(np.log1p(BRIGHTEST) / STEP)

# Step of DGP, its exact limits, and the code of hours without DGP
DGP_STEP = 0.001
DGP_LIMITS = (0.35, 0.40, 0.45)
DARK = 65_535


@dataclass(frozen=True, eq=False)
class HourlyCodes:
    """Quantised hourly values over (step, place), in the order of the page.

    `places` are sensors or views; the time steps are those with daylight.
    """

    codes: UInt16[np.ndarray, "step place"]

    __repr__ = brief

    def compressed(self) -> bytes:
        """Return the codes as gzip data: differences in two planes of bytes.

        Differences are those between successive steps, and of these differences those
        between successive places, modulo 65,536. Their sign is the lowest bit.
        """
        steps = np.diff(self.codes, axis=0, prepend=np.uint16(0))
        both = np.diff(steps, axis=1, prepend=np.uint16(0)).view(np.int16)
        folded = ((both << 1) ^ (both >> 15)).view(np.uint16)
        planes = np.stack([folded & 255, folded >> 8]).astype(np.uint8)
        return gzip.compress(planes.tobytes(), 6, mtime=0)


def decompressed(content: bytes, *, places: int) -> UInt16[np.ndarray, "step place"]:
    """Return the codes of `HourlyCodes.compressed`, as the page reads them.

    >>> codes = np.array([[5, 7], [6, 2]], dtype=np.uint16)
    >>> decompressed(HourlyCodes(codes).compressed(), places=2).tolist()
    [[5, 7], [6, 2]]
    """
    low, high = np.frombuffer(gzip.decompress(content), np.uint8).reshape(2, -1)
    folded = (low.astype(np.uint16) | (high.astype(np.uint16) << 8)).astype(np.uint16)
    both = (folded >> 1) ^ (-(folded & 1).astype(np.int32)).astype(np.uint16)
    table = both.reshape(-1, places)
    steps = np.cumsum(table, axis=1, dtype=np.uint16)
    return np.asarray(np.cumsum(steps, axis=0, dtype=np.uint16))


def hourly_illuminance(
    lux: Float[np.ndarray, "place step"], limits: Sequence[float]
) -> HourlyCodes:
    """Quantise illuminance [lux]; the `limits` [lux] are exact."""
    codes = illuminance_codes(lux, step=STEP).astype(np.int64)
    for limit in limits:
        codes = _kept_beside(codes, lux >= limit, _first_code(limit))
    return HourlyCodes(np.ascontiguousarray(codes.T.astype(np.uint16)))


def decoded_illuminance(codes: UInt16[np.ndarray, "*batch"]) -> np.ndarray:
    """Return the illuminance [lux] of codes, as the page computes it."""
    return np.asarray(np.expm1(codes * STEP))


def hourly_dgp(dgp: Float[np.ndarray, "place step"]) -> HourlyCodes:
    """Quantise DGP to steps of 0.001; limits of glare categories are exact."""
    known = np.isfinite(dgp)
    value = np.where(known, dgp, 0.0)
    codes = np.round(np.clip(value, 0, 1) / DGP_STEP).astype(np.int64)
    for limit in DGP_LIMITS:
        codes = _kept_beside(codes, value > limit, round(limit / DGP_STEP) + 1)
    table = np.where(known, codes, DARK).T.astype(np.uint16)
    return HourlyCodes(np.ascontiguousarray(table))


def _first_code(limit: float) -> int:
    # First code whose value reaches a limit
    code = int(np.log1p(limit) / STEP)
    return code + int(np.argmax(np.expm1(np.arange(code, code + 3) * STEP) >= limit))


def _kept_beside(
    codes: Int[np.ndarray, "place step"],
    reached: Bool[np.ndarray, "place step"],
    first: int,
) -> Int[np.ndarray, "place step"]:
    # Codes from `first` on where a limit is reached, smaller codes elsewhere
    kept = np.where(reached, np.maximum(codes, first), np.minimum(codes, first - 1))
    return np.asarray(kept)
