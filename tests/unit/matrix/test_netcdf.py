"""Matrices in NetCDF: nothing is lost, the same bytes every time, damage is refused."""

import hashlib

import h5netcdf
import numpy as np
import pytest
import xarray as xr
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.bands import GREY, RGB, Bands, unnamed_bands
from clerestory.errors import InputError, OutputError
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import (
    sensor_axis,
    sky_axis,
    time_axis,
    unknown_axis,
    window_axis,
)
from clerestory.matrix.netcdf import read_netcdf, write_netcdf
from clerestory.matrix.transfer_matrix import TransferMatrix

HALF = klems("half")
HOURS = np.datetime64("2019-06-21T00:30", "s") + np.arange(24) * np.timedelta64(1, "h")


def matrix(rows, columns, *, channels=3, dtype=float, components=0):
    rng = np.random.default_rng(5)
    shape = (channels, rows.size, columns.size)
    values = rng.random(shape).astype(dtype)
    spread = rng.random((components, *shape)).astype(np.float32) if components else None
    return TransferMatrix(values, rows, columns, spread)


NINE = Bands(
    tuple(f"{start} nm" for start in range(380, 780, 45)),
    tuple(np.linspace(1.0, 30.0, 9).tolist()),
    tuple((float(start), start + 45.0) for start in range(380, 780, 45)),
)


@pytest.mark.parametrize(
    "bands", [RGB, GREY, NINE, unnamed_bands(2), Bands(("x",), None, ((380.0, 780.0),))]
)
def test_bands_are_read_as_written(tmp_path, bands):
    values = np.ones((len(bands), 2, 3))
    written = TransferMatrix(values, sensor_axis(2), unknown_axis(3), bands=bands)
    write_netcdf(tmp_path / "a.nc", written)
    assert read_netcdf(tmp_path / "a.nc").bands == bands


def edit(path):
    """Open the NetCDF data of a file to change them; `reseal` makes it whole again."""
    path.write_bytes(path.read_bytes()[:-72])
    return h5netcdf.File(path, "a")


def reseal(path):
    """Append the sum that the format asks for."""
    data = path.read_bytes()
    path.write_bytes(data + b"\nsha256 " + hashlib.sha256(data).hexdigest().encode())


AXES = {
    "sensors": sensor_axis(4, ("Tür", "desk 2", "", "α")),
    "many sensors": sensor_axis(9000, tuple(f"sensor {i}" for i in range(9000))),
    "unnamed sensors": sensor_axis(4),
    "window": window_axis("interior", HALF, "south façade"),
    "outside": window_axis("exterior", klems("full")),
    "sky": sky_axis(reinhart(2)),
    "times": time_axis(HOURS),
    "unknown": unknown_axis(3),
}


@pytest.mark.parametrize("name", AXES)
def test_axes_are_read_back(tmp_path, name):
    axis = AXES[name]
    path = tmp_path / "a.nc"
    write_netcdf(path, matrix(axis, unknown_axis(2)))
    read = read_netcdf(path).rows
    assert (read.kind, read.size, read.window) == (axis.kind, axis.size, axis.window)
    assert read.names == axis.names
    assert (read.partition is None) == (axis.partition is None)
    assert read.describe() == axis.describe()
    assert read.fits(axis)
    if axis.times is not None:
        np.testing.assert_array_equal(read.times, axis.times)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("components", [0, 8])
def test_values_and_errors_survive_to_the_bit(tmp_path, dtype, components):
    original = matrix(
        AXES["sensors"], AXES["window"], dtype=dtype, components=components
    )
    write_netcdf(tmp_path / "a.nc", original)
    read = read_netcdf(tmp_path / "a.nc")
    np.testing.assert_array_equal(read.values, original.values)
    assert read.values.dtype == dtype
    np.testing.assert_array_equal(read.standard_error, original.standard_error)
    assert (read.components is None) == (components == 0)


def test_same_matrix_gives_the_same_bytes(tmp_path):
    for name in ("a.nc", "b.nc"):
        write_netcdf(
            tmp_path / name, matrix(AXES["sensors"], AXES["sky"], components=4)
        )
    assert (tmp_path / "a.nc").read_bytes() == (tmp_path / "b.nc").read_bytes()


def test_xarray_opens_the_file(tmp_path):
    original = matrix(AXES["sensors"], AXES["times"], components=2)
    write_netcdf(tmp_path / "a.nc", original)
    with xr.open_dataset(tmp_path / "a.nc", engine="h5netcdf") as dataset:
        assert dataset["values"].dims == ("channel", "row", "column")
        assert dataset["rows"].attrs["kind"] == "sensor"
        np.testing.assert_array_equal(dataset["values"], original.values)
        np.testing.assert_array_equal(dataset["column_times"], HOURS)


def test_products_of_read_matrices_fit(tmp_path):
    V = matrix(AXES["sensors"], window_axis("interior", HALF))
    T = matrix(window_axis("interior", HALF), window_axis("exterior", HALF))
    for name, factor in (("v.nc", V), ("t.nc", T)):
        write_netcdf(tmp_path / name, factor)
    product = read_netcdf(tmp_path / "v.nc") @ read_netcdf(tmp_path / "t.nc")
    np.testing.assert_array_equal(product.values, (V @ T).values)


def test_other_files_are_refused(tmp_path):
    for content in (
        b"",
        b"CDF\x01",
        b"\x89HDF\r\n\x1a\n" + b"\0" * 100,
        b"#?RADIANCE\n",
    ):
        (tmp_path / "a.nc").write_bytes(content)
        with pytest.raises(InputError, match="a complete matrix file expected"):
            read_netcdf(tmp_path / "a.nc")


def test_results_of_other_programs_are_refused(tmp_path):
    path = tmp_path / "a.nc"
    xr.Dataset({"x": ("y", [1.0])}).to_netcdf(path, engine="h5netcdf")
    with pytest.raises(InputError, match="not written by Clerestory"):
        read_netcdf(path)
    reseal(path)
    with pytest.raises(InputError, match="file format unknown; 'Clerestory"):
        read_netcdf(path)


def test_sealed_files_without_matrices_are_refused(tmp_path):
    path = tmp_path / "a.nc"
    path.write_bytes(b"no HDF5 at all")
    reseal(path)
    with pytest.raises(InputError, match="damaged or not NetCDF-4"):
        read_netcdf(path)


def test_missing_file_and_folder_are_distinguished(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_netcdf(tmp_path / "none.nc")
    with pytest.raises(OutputError):
        write_netcdf(tmp_path / "none" / "a.nc", matrix(AXES["sensors"], AXES["times"]))


@pytest.mark.parametrize(
    ("attribute", "value", "message"),
    [
        ("kind", "moon", "kind of the rows is 'moon'"),
        ("ring_count", np.array([1, 8]), "one limit more than rings"),
        (
            "ring_count",
            np.array([1, 8, 12, 16, 20, 12, 9]),
            "77 rows, 78 patches; one per patch",
        ),
        ("ring_limits_rad", np.arange(8.0), "monotonic limits from 0 to 90"),
    ],
)
def test_contradicting_axes_are_refused(tmp_path, attribute, value, message):
    path = tmp_path / "a.nc"
    write_netcdf(path, matrix(AXES["window"], AXES["unknown"]))
    with edit(path) as file:
        del file.variables["rows"].attrs[attribute]
        file.variables["rows"].attrs[attribute] = value
    reseal(path)
    with pytest.raises(InputError, match=message):
        read_netcdf(path)


def test_values_that_are_not_in_the_file_are_refused(tmp_path):
    """A header may claim any size; chunked storage keeps such a file small."""
    path = tmp_path / "a.nc"
    with h5netcdf.File(path, "w") as file:
        file.attrs["format"] = "Clerestory transfer matrix 1"
        file.dimensions = {"channel": 1, "row": 10**6, "column": 10**6}
        file.create_variable(
            "values", ("channel", "row", "column"), "f8", chunks=(1, 1000, 1000)
        )
    reseal(path)
    with pytest.raises(InputError, match="a complete file expected"):
        read_netcdf(path)


@settings(
    max_examples=60,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(cut=st.integers(0, 300), flip=st.integers(0, 20_000), byte=st.integers(0, 255))
def test_damaged_files_are_refused(tmp_path, cut, flip, byte):
    """A file that was cut or in which any bit flipped is never opened."""
    path = tmp_path / "a.nc"
    write_netcdf(path, matrix(sensor_axis(2), AXES["unknown"], components=2))
    whole = path.read_bytes()
    content = bytearray(whole)
    content[flip % len(content)] = byte
    content = bytes(content[: len(content) - (cut if cut % 2 else 0)])
    path.write_bytes(content)
    if content == whole:
        read_netcdf(path)
    else:
        with pytest.raises(InputError, match="a complete matrix file expected"):
            read_netcdf(path)
