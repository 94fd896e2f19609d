"""Sky matrix S: radiance of every sky patch at every time step.

The matrix is stored as achromatic radiance times a colour per patch, plus a sparse
matrix of the sun. Memory and, with `SkyResponse`, the time of a matrix product are the
same as for a single band.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float, Float32
from scipy.sparse import csc_array, csr_array

from clerestory.bands import GREY, RGB, Bands, common_bands
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import MatrixError
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.matrix.axis import Axis, sky_axis, time_axis
from clerestory.matrix.transfer_matrix import (
    TransferMatrix,
    illuminance_dataset,
    require_fit,
)
from clerestory.sky.sky_product import fold, lit_steps, product_blocks, row_blocks

if TYPE_CHECKING:
    import xarray as xr

# Rows or columns per block, so that a block fits in the cache
_BLOCK = 64


@dataclass(frozen=True, eq=False)
class SkyMatrix:
    """Radiance of the ground and the sky patches over time.

    The radiance in band b is colour[b] · diffuse + sun_colour[b] · sun.

    Attributes
    ----------
    partition : ground (patch 0) and sky patches
    times : centres of the time steps, local standard time
    diffuse : achromatic radiance of ground and sky [W/(m²·sr)]
    colour : factor on `diffuse` in each band and patch; ground reflectance for patch 0
    sun : radiance of the direct sun in each patch [W/(m²·sr)], over (patch, time)
    sun_colour : factor on `sun` in each band
    attributes : provenance of the matrix
    bands : spectral bands

    Raises
    ------
    MatrixError : the shapes disagree, or a radiance is negative or not finite
    """

    partition: SkyPartition
    times: np.ndarray
    diffuse: Float32[np.ndarray, "patch time"]
    colour: Float[np.ndarray, "band patch"]
    sun: csc_array
    sun_colour: Float[np.ndarray, " band"]
    attributes: Mapping[str, str | float]
    bands: Bands = RGB

    # Let `array @ sky` raise a TypeError instead of using NumPy's operator
    __array_ufunc__ = None

    __repr__ = brief

    def __post_init__(self) -> None:
        shape = (len(self.partition), len(self.times))
        require(
            self.diffuse.shape == self.sun.shape == shape,
            f"shape of the sky is {self.diffuse.shape}, shape of the sun is"
            f" {self.sun.shape}; {shape} (patches, time steps) expected",
            error=MatrixError,
        )
        bands = len(self.bands)
        require(
            self.colour.shape == (bands, shape[0])
            and self.sun_colour.shape == (bands,),
            f"colour has shape {self.colour.shape}, sun_colour {self.sun_colour.shape};"
            f" ({bands} bands, {shape[0]} patches) and ({bands} bands,) expected",
            error=MatrixError,
        )
        # NaN fails the first comparison, infinity the second
        for part in (self.diffuse, self.sun.data, self.colour, self.sun_colour):
            require(
                not part.size or (part.min() >= 0 and part.max() < np.inf),
                "radiance or colour is negative or not finite; finite numbers of 0 or"
                " more expected",
                error=MatrixError,
            )

    @property
    def rows(self) -> Axis:
        """Axis of ground and sky patches."""
        return sky_axis(self.partition)

    @property
    def columns(self) -> Axis:
        """Axis of time steps."""
        return time_axis(self.times)

    @property
    def values(self) -> Float32[np.ndarray, "band patch time"]:
        """Radiance [W/(m²·sr)] as a dense array over bands, patches and time steps."""
        return self.block(slice(None))

    def block(self, steps: slice) -> Float32[np.ndarray, "band patch block"]:
        """Radiance of all patches in the given time steps [W/(m²·sr)]."""
        colour = self.colour.astype(np.float32)[:, :, None]
        radiance = colour * self.diffuse[None, :, steps]
        sun = self.sun[:, steps].tocoo()
        patch, step = sun.coords
        tint = self.sun_colour.astype(np.float32)[:, None]
        radiance[:, patch, step] += tint * sun.data
        return np.asarray(radiance)

    def select(self, steps: slice | np.ndarray) -> "SkyMatrix":
        """Return the sky matrix of the time steps in a slice or boolean mask."""
        chosen = np.arange(len(self.times))[steps]
        return replace(
            self,
            times=self.times[chosen],
            diffuse=self.diffuse.T[steps].T,
            sun=self.sun[:, chosen],
        )

    def mean(self) -> "SkyMatrix":
        """Return the mean over all time steps, including nights, as a one-step matrix.

        The mean radiance has the time of the first time step.
        """
        weight = csc_array(np.full((len(self.times), 1), 1 / len(self.times)))
        diffuse = self.diffuse.mean(axis=1, keepdims=True, dtype=float)
        return replace(
            self,
            times=self.times[:1],
            diffuse=diffuse.astype(np.float32),
            sun=csc_array(self.sun @ weight).astype(np.float32),
        )

    def to_transfer_matrix(self) -> TransferMatrix:
        """Return the radiance of ground and sky in all bands as a dense matrix."""
        shape = len(self.bands), len(self.partition), len(self.times)
        values = np.empty(shape, np.float32)
        for start in range(0, len(self.times), _BLOCK):
            steps = slice(start, start + _BLOCK)
            values[:, :, steps] = self.block(steps)
        return TransferMatrix(values, self.rows, self.columns, bands=self.bands)

    def luminance(self) -> TransferMatrix:
        """Return the luminance of the patches [cd/m²] as a matrix with one channel."""
        weights = self.bands.weights
        tint = (weights @ self.colour).astype(np.float32)
        sun = self.sun.tocoo()
        values = self.diffuse * tint[:, None]
        values[sun.coords] += np.float32(weights @ self.sun_colour) * sun.data
        return TransferMatrix(values[None], self.rows, self.columns, bands=GREY)

    def row_blocks(self) -> Iterator[Float32[np.ndarray, "patch time band"]]:
        """Yield the radiance [W/(m²·sr)] of blocks of patches, in matrix file order."""
        sun = csr_array(self.sun)
        tint = self.sun_colour.astype(np.float32)
        for start in range(0, len(self.partition), _BLOCK):
            patches = slice(start, start + _BLOCK)
            grey = np.ascontiguousarray(self.diffuse[patches])
            radiance = np.empty((*grey.shape, len(self.bands)), np.float32)
            for channel, colour in enumerate(self.colour[:, patches, None]):
                factor = colour.astype(np.float32)
                np.multiply(grey, factor, out=radiance[:, :, channel])
            shining = sun[patches].tocoo()
            radiance[shining.coords] += shining.data[:, None] * tint
            yield radiance

    def __rmatmul__(self, transfer: object) -> "SkyResponse":
        """Return the product of a transfer and a sky matrix, for later evaluation."""
        if not isinstance(transfer, TransferMatrix):
            return NotImplemented
        return SkyResponse(transfer, self)


@dataclass(frozen=True, eq=False)
class SkyResponse:
    """Product of transfer and sky matrix, evaluated by `illuminance` or `rgb`."""

    transfer: TransferMatrix
    sky: SkyMatrix

    def __post_init__(self) -> None:
        require_fit(self.transfer.columns, self.sky.rows)
        common_bands(self._parts())

    def _parts(self) -> Iterator[tuple[Bands, int]]:
        yield self.transfer.bands, len(self.transfer.values)
        yield self.sky.bands, len(self.sky.colour)

    def illuminance(self) -> "xr.Dataset":
        """Illuminance and its standard error at each sensor and time step [lux].

        The bands are summed, weighted by luminous efficacy, before the matrix product;
        steps without sky and sun radiance are skipped.
        """
        weights, sky = common_bands(self._parts()).weights, self.sky
        lit = lit_steps(sky.diffuse, sky.sun)
        values, components = self.transfer.values[None], self.transfer.components
        _, _, rows, patches = values.shape
        lux, error = np.zeros((2, rows, len(sky.times)))
        layers = 1 if components is None else 1 + len(components)
        for part in row_blocks(rows, layers=layers, patches=patches):
            block = values[:, :, part]
            if components is not None:
                block = np.concatenate([block, components[:, :, part]])
            folded = (
                fold(block, np.broadcast_to(tint, (len(weights), patches)), weights)
                for tint in (sky.colour, sky.sun_colour[:, None])
            )
            for steps, received in product_blocks(
                *(one.reshape(-1, patches) for one in folded),
                diffuse=sky.diffuse,
                direct=sky.sun,
                steps=lit,
            ):
                light = received.reshape(layers, -1, len(steps))
                lux[part][:, steps] = light[0]
                error[part][:, steps] = np.sqrt(np.sum(np.square(light[1:]), axis=0))
        return illuminance_dataset(
            lux, error, sensors=self.transfer.rows, times=sky.columns
        )

    def rgb(self) -> TransferMatrix:
        """Return daylight coefficients times sky radiance, with standard errors."""
        return self.transfer @ self.sky.to_transfer_matrix()
