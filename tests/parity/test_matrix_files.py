"""Matrix files exchanged with Radiance's rmtxop, dctimestep and gendaymtx."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sky_axis, unknown_axis
from clerestory.matrix.radiance_format import read_matrix, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix

pyradiance = pytest.importorskip("pyradiance")
BIN = Path(pyradiance.__file__).parent / "bin"

ENCODINGS = ("ascii", "float", "double")


def radiance(*command):
    """Standard output of a Radiance program."""
    command = [str(BIN / command[0]), *map(str, command[1:])]
    return subprocess.run(command, check=True, capture_output=True).stdout


def random_matrix(rows, columns, *, seed=1):
    values = np.random.default_rng(seed).random((3, rows, columns))
    return TransferMatrix(values, unknown_axis(rows), unknown_axis(columns))


@pytest.mark.parametrize("ours", ENCODINGS)
@pytest.mark.parametrize("theirs", ENCODINGS)
def test_rmtxop_reads_what_we_write_and_we_read_what_it_writes(tmp_path, ours, theirs):
    """`rmtxop -f[afd] a.mtx`; it computes in single precision, 8 digits in ascii."""
    original = random_matrix(7, 11)
    write_matrix(tmp_path / "a.mtx", original, encoding=ours, command="test")
    out = radiance("rmtxop", f"-f{theirs[0]}", tmp_path / "a.mtx")
    (tmp_path / "b.mtx").write_bytes(out)
    copy = read_matrix(tmp_path / "b.mtx")
    np.testing.assert_allclose(copy.values, original.values, rtol=3e-7)
    assert copy.values.dtype == (np.float32 if theirs == "float" else np.float64)


def test_one_component_is_read_from_rmtxop(tmp_path):
    """`rmtxop -c 0.265 0.67 0.065` makes luminance of RGB."""
    original = random_matrix(3, 4)
    write_matrix(tmp_path / "a.mtx", original)
    out = radiance("rmtxop", "-fd", "-c", ".265", ".67", ".065", tmp_path / "a.mtx")
    (tmp_path / "b.mtx").write_bytes(out)
    grey = original.weighted((0.265, 0.670, 0.065))
    np.testing.assert_allclose(
        read_matrix(tmp_path / "b.mtx").values, grey.values, rtol=1e-6
    )


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_products_equal_those_of_rmtxop(tmp_path, encoding):
    left, right = random_matrix(5, 8), random_matrix(8, 6, seed=2)
    for name, factor in (("a.mtx", left), ("b.mtx", right)):
        write_matrix(tmp_path / name, factor, encoding=encoding)
    out = radiance("rmtxop", "-fd", tmp_path / "a.mtx", tmp_path / "b.mtx")
    (tmp_path / "c.mtx").write_bytes(out)
    product = read_matrix(tmp_path / "c.mtx")
    np.testing.assert_allclose(product.values, (left @ right).values, rtol=1e-6)


@pytest.mark.parametrize("encoding", [[], ["-of"], ["-od"]])
def test_sky_of_gendaymtx_has_rows_of_patches_and_columns_of_time(tmp_path, encoding):
    """`gendaymtx -m 1` for three hours: 146 rows, 3 columns, RGB."""
    wea = tmp_path / "a.wea"
    wea.write_text(
        "place test\nlatitude 37.7\nlongitude 122.2\ntime_zone 120\n"
        "site_elevation 2\nweather_data_file_units 1\n"
        "6 21 9.5 500 100\n6 21 12.5 800 100\n6 21 15.5 500 100\n"
    )
    out = radiance("gendaymtx", "-m", "1", *encoding, wea)
    (tmp_path / "a.smx").write_bytes(out)
    sky = read_matrix(tmp_path / "a.smx", rows=sky_axis(reinhart(1)))
    assert sky.values.shape == (3, 146, 3)
    brightest = sky.values[1, 1:].argmax(axis=0)
    assert len(set(brightest.tolist())) == 3
