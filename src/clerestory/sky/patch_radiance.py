"""Sky matrix S: radiance of every sky patch at every time step.

The matrix is stored as achromatic radiance times a colour per patch, plus a sparse
matrix of the sun. Memory and, with `SkyResponse`, the time of a matrix product are the
same as for a single band. Skies whose colour changes over time have chromatic parts of
the same form: two for the colour of skylight, and some for that of the sun, however
many bands there are.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, final

import numpy as np
from jaxtyping import Float, Float32, Int
from scipy.sparse import csc_array, csr_array

from clerestory.argument_types import checked_fields
from clerestory.bands import GREY, RGB, Bands, common_bands
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import MatrixError
from clerestory.hemisphere.reinhart import SkyPartition
from clerestory.matrix.axis import Axis, sky_axis, time_axis
from clerestory.matrix.expansion import with_derivatives
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


@final
@dataclass(frozen=True, eq=False)
class ChromaticPart:
    """Part of a sky's radiance that changes its spectrum but not its luminance.

    The radiance in band b is colour[b] · diffuse + sun_colour[b] · sun, and may be
    negative.
    """

    diffuse: Float32[np.ndarray, "patch time"]
    colour: Float[np.ndarray, "band patch"]
    sun: csc_array
    sun_colour: Float[np.ndarray, " band"]

    __repr__ = brief

    def select(self, steps: slice | np.ndarray) -> "ChromaticPart":
        """Return the part in the time steps in a slice or boolean mask."""
        chosen = np.arange(self.diffuse.shape[1])[steps]
        diffuse = self.diffuse.T[steps].T
        return replace(self, diffuse=diffuse, sun=self.sun[:, chosen])

    def mean(self) -> "ChromaticPart":
        """Return the mean over all time steps."""
        return replace(self, **_means(self.diffuse, self.sun))


@checked_fields
@dataclass(frozen=True, eq=False)
class SkyMatrix:
    """Radiance of the ground and the sky patches over time.

    The radiance in band b is colour[b] · diffuse + sun_colour[b] · sun, plus the
    radiance of the chromatic parts.

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
    chromatic : parts without luminance, of skies whose colour changes over time

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
    chromatic: tuple[ChromaticPart, ...] = ()

    # Let `array @ sky` raise a TypeError instead of using NumPy's operator
    __array_ufunc__ = None

    __repr__ = brief

    def __post_init__(self) -> None:
        shape, bands = (len(self.partition), len(self.times)), len(self.bands)
        for one in self.parts:
            require(
                one.diffuse.shape == one.sun.shape == shape,
                f"shape of the sky is {one.diffuse.shape}, shape of the sun is"
                f" {one.sun.shape}; {shape} (patches, time steps) expected",
                error=MatrixError,
            )
            require(
                one.colour.shape == (bands, shape[0])
                and one.sun_colour.shape == (bands,),
                f"colour has shape {one.colour.shape}, sun_colour"
                f" {one.sun_colour.shape}; ({bands} bands, {shape[0]} patches) and"
                f" ({bands} bands,) expected",
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
    def parts(self) -> tuple["SkyMatrix | ChromaticPart", ...]:
        """The matrix itself and its chromatic parts, whose radiances are added."""
        return self, *self.chromatic

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
        steps_in = range(*steps.indices(len(self.times)))
        shape = len(self.bands), len(self.partition), len(steps_in)
        radiance = np.zeros(shape, np.float32)
        for one in self.parts:
            colour = one.colour.astype(np.float32)[:, :, None]
            radiance += colour * one.diffuse[None, :, steps]
            sun = one.sun[:, steps].tocoo()
            patch, step = sun.coords
            tint = one.sun_colour.astype(np.float32)[:, None]
            radiance[:, patch, step] += tint * sun.data
        return radiance

    def select(self, steps: slice | np.ndarray) -> "SkyMatrix":
        """Return the sky matrix of the time steps in a slice or boolean mask."""
        chosen = np.arange(len(self.times))[steps]
        return replace(
            self,
            times=self.times[chosen],
            diffuse=self.diffuse.T[steps].T,
            sun=self.sun[:, chosen],
            chromatic=tuple(one.select(steps) for one in self.chromatic),
        )

    def mean(self) -> "SkyMatrix":
        """Return the mean over all time steps, including nights, as a one-step matrix.

        The mean radiance has the time of the first time step.
        """
        return replace(
            self,
            times=self.times[:1],
            chromatic=tuple(one.mean() for one in self.chromatic),
            **_means(self.diffuse, self.sun),
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
        suns = [csr_array(one.sun) for one in self.parts]
        for start in range(0, len(self.partition), _BLOCK):
            patches = slice(start, start + _BLOCK)
            shape = self.diffuse[patches].shape
            radiance = np.zeros((*shape, len(self.bands)), np.float32)
            for one, sun in zip(self.parts, suns, strict=True):
                grey = np.ascontiguousarray(one.diffuse[patches])
                for channel, colour in enumerate(one.colour[:, patches, None]):
                    radiance[:, :, channel] += grey * colour.astype(np.float32)
                shining = sun[patches].tocoo()
                tint = one.sun_colour.astype(np.float32)
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
        steps without sky and sun radiance are skipped. Derivatives of the transfer
        matrix give those of the illuminance.
        """
        evaluate = SkyResponse._illuminance
        return with_derivatives(
            self.transfer, lambda transfer: evaluate(SkyResponse(transfer, self.sky))
        )

    def _illuminance(self) -> "xr.Dataset":
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
            for steps, received in self._products(block, weights, lit):
                light = received.reshape(layers, -1, len(steps))
                lux[part][:, steps] = light[0]
                error[part][:, steps] = np.sqrt(np.sum(np.square(light[1:]), axis=0))
        return illuminance_dataset(
            lux, error, sensors=self.transfer.rows, times=sky.columns
        )

    def _products(
        self,
        values: Float[np.ndarray, "layer channel row patch"],
        weights: Float[np.ndarray, " band"],
        lit: Int[np.ndarray, " lit"],
    ) -> Iterator[tuple[Int[np.ndarray, " block"], Float32[np.ndarray, "row block"]]]:
        # Weighted light in blocks of time steps, summed over the parts of the sky
        shape = len(weights), values.shape[-1]
        found = []
        for one in self.sky.parts:
            folded = (
                fold(values, np.broadcast_to(tint, shape), weights)
                for tint in (one.colour, one.sun_colour[:, None])
            )
            rows = (each.reshape(-1, shape[1]) for each in folded)
            products = product_blocks(
                *rows, diffuse=one.diffuse, direct=one.sun, steps=lit
            )
            found.append(products)
        for blocks in zip(*found, strict=True):
            yield blocks[0][0], sum((light for _, light in blocks[1:]), blocks[0][1])

    def rgb(self) -> TransferMatrix:
        """Return daylight coefficients times sky radiance, with standard errors."""
        return self.transfer @ self.sky.to_transfer_matrix()


def _means(diffuse: np.ndarray, sun: csc_array) -> dict[str, Any]:
    # Mean radiance of sky and sun over all time steps, as matrices of one step
    count = diffuse.shape[1]
    weight = csc_array(np.full((count, 1), 1 / count))
    mean = diffuse.mean(axis=1, keepdims=True, dtype=float)
    return {
        "diffuse": mean.astype(np.float32),
        "sun": csc_array(sun @ weight).astype(np.float32),
    }
