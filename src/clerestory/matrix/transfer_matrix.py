"""Transfer matrices of the daylight methods, with statistical errors.

The error of a traced matrix is stored as *error components*: the deviations of its
independent batches from their mean, scaled so that the variance of any entry is the
sum of their squares. A matrix product multiplies error components like coefficients, so
the standard error of V·T·D·S includes all correlations between coefficients:

    E = A·B   →   components of E = (components of A)·B  and  A·(components of B)
"""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.bands import GREY, RGB, Bands, common_bands, weighted_sum
from clerestory.brief_repr import brief
from clerestory.checks import has_shape, require
from clerestory.errors import MatrixError
from clerestory.matrix.axis import Axis
from clerestory.matrix.derivatives import Derivatives
from clerestory.matrix.expansion import with_derivatives
from clerestory.matrix.product_rule import (
    Factor,
    product_derivatives,
    sum_derivatives,
)

if TYPE_CHECKING:
    import xarray as xr

# Coefficients of a range of rows, and their error components
Entries = tuple[
    Float[np.ndarray, "channel row column"],
    Float[np.ndarray, "component channel row column"] | None,
]

# Raise a MatrixError unless a condition is true
require_matrix = partial(require, error=MatrixError)


@checked_fields
@dataclass(frozen=True, eq=False)
class TransferMatrix:
    """Transfer matrix: quantity at each receiver per unit quantity of each sender.

    Attributes
    ----------
    values : coefficients, with one channel per band or one channel for all bands
    rows, columns : receivers and senders
    components : error components; None for a matrix without statistical error
    bands : spectral bands of the channels
    derivatives : first and second derivatives by parameters of materials; None if not
        asked for

    Raises
    ------
    MatrixError : the shape differs from axes or bands, or a value is not finite
    """

    values: Float[np.ndarray, "channel row column"]
    rows: Axis
    columns: Axis
    components: Float[np.ndarray, "component channel row column"] | None = None
    bands: Bands = RGB
    derivatives: Derivatives | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        shape, bands = self.values.shape, len(self.bands)
        parts = self.components
        axes = f"(1 or {bands} channels, rows, columns)"
        valid = len(shape) == 3 and shape[0] in (1, bands)
        require_matrix(valid, f"matrix of shape {shape}; {axes} expected")
        require_matrix(
            shape[1:] == (self.rows.size, self.columns.size),
            f"matrix of {' x '.join(map(str, shape[1:]))} coefficients;"
            f" {self.rows.describe()} by {self.columns.describe()} expected",
        )
        if parts is not None:
            expected = len(parts), *shape
            has_shape(parts, expected, "array of error components", error=MatrixError)
        if self.derivatives is not None:
            of = self.derivatives.first.shape[1:]
            has_shape(self.values, of, "array of values", error=MatrixError)
        finite = np.all(np.isfinite(self.values))
        require_matrix(finite, "values are not finite; finite numbers expected")

    @property
    def standard_error(self) -> Float[np.ndarray, "channel row column"]:
        """Standard error of each coefficient; zero without error components."""
        if self.components is None:
            return np.zeros_like(self.values)
        error: np.ndarray = np.sqrt(np.sum(np.square(self.components), axis=0))
        return error

    def derivative(self, name: str) -> "TransferMatrix":
        """Return the derivative by the parameter of a material, with its error.

        Raises
        ------
        MatrixError : the matrix has no derivatives
        InputError : no derivative by this parameter
        """
        of = self._differentiated()
        number, parts = of.number(name), of.components
        return replace(
            self,
            values=of.first[number],
            components=None if parts is None else parts[:, number],
            derivatives=None,
        )

    def second_derivative(self, one: str, other: str) -> "TransferMatrix":
        """Return the second derivative by two parameters, without error.

        Raises
        ------
        MatrixError : the matrix has no derivatives
        InputError : no derivative by one of these parameters
        """
        of = self._differentiated()
        values = of.second[of.pair(one, other)]
        return replace(self, values=values, components=None, derivatives=None)

    def _differentiated(self) -> Derivatives:
        if self.derivatives is None:
            message = "matrix without derivatives; traced with `derivatives` expected"
            raise MatrixError(message)
        return self.derivatives

    def _factor(self) -> Factor:
        return Factor(self.values, self.components, self.derivatives)

    def __matmul__(self, other: object) -> "TransferMatrix":
        """Return the matrix product.

        Raises
        ------
        MatrixError : the inner axes or the bands are incompatible
        """
        if not isinstance(other, TransferMatrix):
            return NotImplemented
        require_fit(self.columns, other.rows)
        bands = self._common_bands(other)
        left, right = self.values, other.values
        values = left @ right

        # Propagate the error of each factor through the product
        parts = []
        if self.components is not None:
            parts.append(self.components @ right.astype(self.components.dtype))
        if other.components is not None:
            parts.append(left.astype(other.components.dtype) @ other.components)
        components = _concatenated(parts, values.shape)

        rows = self.rows.at_window(other.rows.window)
        columns = other.columns.at_window(self.columns.window)
        derivatives = product_derivatives(self._factor(), other._factor())
        return TransferMatrix(values, rows, columns, components, bands, derivatives)

    def __add__(self, other: "TransferMatrix") -> "TransferMatrix":
        """Return the sum of two statistically independent matrices."""
        if not isinstance(other, TransferMatrix):
            return NotImplemented
        require_matrix(
            self.rows.fits(other.rows) and self.columns.fits(other.columns),
            f"sum of {self.rows.describe()} by {self.columns.describe()} and"
            f" {other.rows.describe()} by {other.columns.describe()}; matrices with"
            " equal rows and columns expected",
        )
        bands = self._common_bands(other)
        values = self.values + other.values
        parts = [m.components for m in (self, other) if m.components is not None]
        components = _concatenated(parts, values.shape)
        columns = replace(self.columns, window=None)
        derivatives = sum_derivatives(self._factor(), other._factor(), values.shape)
        return TransferMatrix(
            values, self.rows, columns, components, bands, derivatives
        )

    def _common_bands(self, other: "TransferMatrix") -> Bands:
        return common_bands((m.bands, len(m.values)) for m in (self, other))

    def read(self, rows: slice) -> Entries:
        """Return a range of rows and their error components."""
        parts = self.components
        return self.values[:, rows], None if parts is None else parts[:, :, rows]

    def select_rows(self, rows: slice) -> "TransferMatrix":
        """Return a range of rows as a matrix."""
        names = self.rows.names[rows] if self.rows.names else None
        axis = replace(self.rows, size=len(range(self.rows.size)[rows]), names=names)
        values, components = self.read(rows)
        return replace(
            self,
            values=values,
            rows=axis,
            components=components,
            derivatives=self.derivatives and self.derivatives.rows(rows),
        )

    def weighted(
        self, weights: Sequence[float] | Float[np.ndarray, " band"]
    ) -> "TransferMatrix":
        """Return a matrix with one channel: the sum of the bands times `weights`.

        A matrix with one channel is multiplied by the sum of the weights.
        """
        factor = np.asarray(weights, dtype=float)
        components = self.components
        if components is not None:
            components = weighted_sum(components, factor, axis=1)[:, None]
        return replace(
            self,
            values=weighted_sum(self.values, factor, axis=0)[None],
            components=components,
            bands=GREY,
            derivatives=self.derivatives and self.derivatives.weighted(factor),
        )

    def illuminance(self) -> "xr.Dataset":
        """Illuminance [lux] of the sensors at each time step, with its standard error.

        The coefficients must be irradiance [W/m²] in bands of known luminous efficacy.
        In RGB, illuminance is 179 lm/W times 0.265 R + 0.670 G + 0.065 B. Derivatives
        of the matrix give those of the illuminance.

        Raises
        ------
        MatrixError : columns are not time steps
        InputError : the luminous efficacy of the bands is unknown
        """
        require_matrix(
            self.columns.kind in ("time", "unknown"),
            f"columns are {self.columns.describe()}; multiply by a sky matrix first",
        )
        return with_derivatives(self, TransferMatrix._illuminance)

    def _illuminance(self) -> "xr.Dataset":
        lux = self.weighted(self.bands.weights)
        return illuminance_dataset(
            lux.values[0], lux.standard_error[0], sensors=self.rows, times=self.columns
        )


def _concatenated(
    components: Sequence[np.ndarray], shape: tuple[int, ...]
) -> Float[np.ndarray, "component channel row column"] | None:
    parts = [np.broadcast_to(part, (len(part), *shape)) for part in components]
    return np.concatenate(parts) if parts else None


def require_fit(columns: Axis, rows: Axis) -> None:
    """Require that the inner axes of a product have the same meaning."""
    hint = "; put the transmission matrix of a BSDF between them"
    unscattered = (columns.kind, rows.kind) == ("interior", "exterior")
    require_matrix(
        columns.fits(rows),
        f"the left matrix has columns of {columns.describe()}, the right matrix has"
        f" rows of {rows.describe()}; equal axes expected{hint * unscattered}",
    )


def illuminance_dataset(
    illuminance: Float[np.ndarray, "sensor time"],
    standard_error: Float[np.ndarray, "sensor time"],
    *,
    sensors: Axis,
    times: Axis,
) -> "xr.Dataset":
    """Return illuminance and standard error [lux] as a dataset over (sensor, time)."""
    names = list(sensors.names) if sensors.names else np.arange(sensors.size)
    moments = times.times if times.times is not None else np.arange(times.size)

    # Import here: loading xarray takes longer than most products
    axes, long_name = ("sensor", "time"), "standard error of the illuminance"
    error = axes, standard_error, {"units": "lux", "long_name": long_name}
    labelled: xr.Dataset = importlib.import_module("xarray").Dataset(
        {"illuminance": (axes, illuminance, {"units": "lux"}), "standard_error": error},
        coords={"sensor": names, "time": moments},
        attrs={"quantity": "illuminance", "units": "lux"},
    )
    return labelled
