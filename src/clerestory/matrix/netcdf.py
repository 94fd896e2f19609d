"""NetCDF files of transfer matrices: values, standard errors, bands and axes.

A NetCDF-4 file, readable by xarray, Panoply or ncdump, has a variable `values`
(channel, row, column), a variable `components` (component, channel, row, column) if
there is a statistical error, and variables `rows` and `columns` whose attributes label
the axes. A differentiated matrix has `derivatives` (parameter, …),
`second_derivatives` (pair, …) and `derivative_components`. Attributes of `values` name
the spectral bands; files without these attributes are in RGB or grey. Equal matrices
are written as identical bytes.

A SHA-256 checksum follows the NetCDF data. It is checked before the file is opened,
since libhdf5 may hang on a damaged file. Files are written with h5netcdf, which follows
the NetCDF conventions, and read with h5py.
"""

import hashlib
import io
import math
from pathlib import Path
from typing import Any, get_args

import h5netcdf  # type: ignore[import-untyped]
import h5py
import numpy as np

from clerestory.bands import RGB, Bands
from clerestory.checks import one_of, require
from clerestory.errors import InputError, located
from clerestory.escaping import printable
from clerestory.files import read_bytes, replace_file
from clerestory.hemisphere.partition import RingPartition
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import Axis, Kind
from clerestory.matrix.derivatives import Derivatives, Parameter, Quantity
from clerestory.matrix.transfer_matrix import TransferMatrix

_FORMAT = "Clerestory transfer matrix 1"

# Length of the checksum line [bytes]: line feed, "sha256 " and 64 hexadecimal digits.
SEAL_LENGTH = 1 + len("sha256 ") + 64

# Times are stored as whole nanoseconds since 1970, as in NumPy.
_TIME = "datetime64[ns]"


def write_netcdf(path: str | Path, matrix: TransferMatrix) -> None:
    """Write a matrix with its error components, bands and axes."""
    buffer = io.BytesIO()
    with h5netcdf.File(buffer, "w") as file:
        file.attrs["format"] = _FORMAT
        channels, rows, columns = matrix.values.shape
        file.dimensions = {"channel": channels, "row": rows, "column": columns}
        values = _add(file, "values", ("channel", "row", "column"), matrix.values)
        _write_bands(values, matrix.bands)
        if matrix.components is not None:
            file.dimensions["component"] = len(matrix.components)
            dimensions = "component", "channel", "row", "column"
            _add(file, "components", dimensions, matrix.components)
        if matrix.derivatives is not None:
            _write_derivatives(file, matrix.derivatives)
        _write_axis(file, "row", matrix.rows)
        _write_axis(file, "column", matrix.columns)
    with replace_file(path) as stream:
        stream.write(buffer.getvalue())
        stream.write(seal(buffer.getbuffer()))


def read_netcdf(path: str | Path) -> TransferMatrix:
    """Return the matrix of a file written by `write_netcdf`."""
    data = read_bytes(path)
    with located(file=path):
        complete = data[-SEAL_LENGTH:] == seal(memoryview(data)[:-SEAL_LENGTH])
        message = (
            "damaged, or not written by Clerestory; a complete matrix file expected"
        )
        require(complete, message)
        try:
            return _read(data)
        except InputError:
            raise
        except Exception as error:  # HDF5 raises many exception types on damage
            reason = " ".join(str(error).split()) or type(error).__name__
            raise InputError(
                f"damaged or not NetCDF-4 ({reason[:120]}); a matrix file expected"
            ) from error


def _read(data: bytes) -> TransferMatrix:
    with h5py.File(io.BytesIO(data), "r") as file:
        found = file.attrs.get("format")
        require(found == _FORMAT, f"file format unknown; {_FORMAT!r} expected")
        size, components = len(data), None
        if "components" in file:
            components = _read_floats(file, "components", size)
        values = _read_floats(file, "values", size)
        axes = _read_axis(file, "row"), _read_axis(file, "column")
        bands = _read_bands(file["values"])
        derivatives = _read_derivatives(file, size) if "derivatives" in file else None
        return TransferMatrix(values, *axes, components, bands, derivatives)


def seal(data: memoryview) -> bytes:
    """Return the checksum line that follows the data of a file."""
    return b"\nsha256 " + hashlib.sha256(data).hexdigest().encode()


def _add(
    file: h5netcdf.File, name: str, dimensions: tuple[str, ...], data: np.ndarray
) -> Any:
    # The HDF5 checksum detects bit errors on disk
    check = {"fletcher32": True} if data.size else {}
    return file.create_variable(
        name, dimensions, data=np.ascontiguousarray(data), **check
    )


def _write_bands(variable: h5netcdf.Variable, bands: Bands) -> None:
    if bands == RGB:  # RGB bands are not labelled, as in version 0.1
        return
    variable.attrs["band_names"] = "\n".join(map(printable, bands.names))
    if bands.efficacy is not None:
        variable.attrs["band_efficacy_lm_per_W"] = np.array(bands.efficacy)
    if bands.limits_nm is not None:
        variable.attrs["band_limits_nm"] = np.ravel(bands.limits_nm)
    if bands.weightings is not None:
        variable.attrs["band_weightings"] = "\n".join(map(printable, bands.weightings))


def _read_bands(variable: h5py.Dataset) -> Bands:
    attributes = variable.attrs
    if "band_names" not in attributes:
        return RGB
    efficacy = attributes.get("band_efficacy_lm_per_W")
    limits = np.reshape(attributes.get("band_limits_nm", ()), (-1, 2))
    weightings = attributes.get("band_weightings")
    return Bands(
        tuple(attributes["band_names"].split("\n")),
        None if efficacy is None else tuple(np.ravel(efficacy).tolist()),
        tuple(map(tuple, limits.tolist())) or None,
        None if weightings is None else tuple(weightings.split("\n")),
    )


def _write_derivatives(file: h5netcdf.File, derivatives: Derivatives) -> None:
    entries = "channel", "row", "column"
    file.dimensions["parameter"] = len(derivatives.parameters)
    file.dimensions["pair"] = len(derivatives.second)
    first = _add(file, "derivatives", ("parameter", *entries), derivatives.first)
    parameters = derivatives.parameters
    first.attrs["names"] = "\n".join(printable(each.name) for each in parameters)
    first.attrs["values"] = np.array([each.value for each in parameters])
    first.attrs["quantities"] = "\n".join(each.quantity for each in parameters)
    _add(file, "second_derivatives", ("pair", *entries), derivatives.second)
    if derivatives.components is not None:
        axes = "component", "parameter", *entries
        if "component" not in file.dimensions:
            file.dimensions["component"] = len(derivatives.components)
        _add(file, "derivative_components", axes, derivatives.components)


def _read_derivatives(file: h5py.File, size: int) -> Derivatives:
    attributes = file["derivatives"].attrs
    names = str(attributes["names"]).split("\n")
    quantities = str(attributes["quantities"]).split("\n")
    values = np.ravel(attributes["values"]).tolist()
    parameters = []
    for name, value, quantity in zip(names, values, quantities, strict=True):
        kind: Any = quantity
        one_of(kind, "quantity of a parameter", choices=get_args(Quantity))
        parameters.append(Parameter(name, value, kind))
    components = None
    if "derivative_components" in file:
        components = _read_floats(file, "derivative_components", size)
    return Derivatives(
        tuple(parameters),
        _read_floats(file, "derivatives", size),
        _read_floats(file, "second_derivatives", size),
        components,
    )


def _write_axis(file: h5netcdf.File, side: str, axis: Axis) -> None:
    # Write the indices of patches, sensors or time steps; attributes label the axis
    variable = _add(file, f"{side}s", (side,), np.arange(axis.size))
    variable.attrs["kind"] = axis.kind
    if axis.window is not None:
        variable.attrs["window"] = printable(axis.window)
    partition = axis.partition
    if isinstance(partition, RingPartition):
        variable.attrs["partition"] = printable(partition.name)
        variable.attrs["ring_count"] = partition.count
        variable.attrs["ring_limits_rad"] = partition.theta
        variable.attrs["azimuth"] = partition.azimuth
    elif partition is not None:
        variable.attrs["sky_subdivision"] = partition.subdivision
    if axis.times is not None:
        moments = np.asarray(axis.times, dtype=_TIME).astype(np.int64)
        times = _add(file, f"{side}_times", (side,), moments)
        times.attrs["units"] = "nanoseconds since 1970-01-01 00:00:00"
    if axis.names is not None:
        text = h5py.string_dtype()
        names = np.array([printable(name) for name in axis.names], dtype=object)
        file.create_variable(f"{side}_names", (side,), dtype=text, data=names)


def _read_floats(file: h5py.File, name: str, length: int) -> np.ndarray:
    # The data are not compressed, so they cannot be longer than the file
    variable = file[name]
    kind, item = variable.dtype.kind, variable.dtype.itemsize
    message = f"{name} of type {variable.dtype}; floating point expected"
    require(kind == "f" and item <= 8, message)
    size = math.prod(variable.shape) * item
    message = f"{name} of {size} bytes in a file of {length}; a complete file expected"
    require(size <= length, message)
    data: np.ndarray = variable[...]
    return data


def _read_axis(file: h5py.File, side: str) -> Axis:
    variable = file[f"{side}s"]
    attributes = variable.attrs
    kind: Kind = attributes["kind"]
    one_of(kind, f"kind of the {side}s", choices=get_args(Kind))
    partition: Any = None
    if "ring_count" in attributes:
        partition = RingPartition(
            str(attributes["partition"]),
            np.atleast_1d(attributes["ring_count"]),
            np.asarray(attributes["ring_limits_rad"], dtype=float),
            azimuth=attributes["azimuth"],
        )
    elif "sky_subdivision" in attributes:
        partition = reinhart(int(np.ravel(attributes["sky_subdivision"])[0]))
    size = int(variable.shape[0])
    count = size if partition is None else len(partition)
    require(count == size, f"{size} {side}s, {count} patches; one per patch expected")
    times, names = file.get(f"{side}_times"), file.get(f"{side}_names")
    return Axis(
        kind,
        size,
        partition=partition,
        window=attributes.get("window"),
        times=None if times is None else times[...].astype(_TIME),
        names=None if names is None else tuple(names.asstr()[...].tolist()),
    )
