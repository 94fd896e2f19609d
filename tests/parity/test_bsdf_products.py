"""V·T·D·S with BSDF files equals dctimestep's, whatever the file's basis and side."""

import subprocess
from importlib.resources import as_file, files
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.matrix.axis import unknown_axis
from clerestory.matrix.radiance_format import read_matrix, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix

pyradiance = pytest.importorskip("pyradiance")
BIN = Path(pyradiance.__file__).parent / "bin"


def random_matrix(rows, columns, seed):
    values = np.random.default_rng(seed).random((3, rows, columns))
    return TransferMatrix(values, unknown_axis(rows), unknown_axis(columns))


def dctimestep(folder, xml, factors):
    """Product of `dctimestep -od V T D S` with the factors written to files."""
    names = []
    for name, factor in zip(("v.mtx", "d.mtx", "s.mtx"), factors, strict=True):
        write_matrix(folder / name, factor, encoding="double")
        names.append(folder / name)
    command = [BIN / "dctimestep", "-od", names[0], xml, *names[1:]]
    out = subprocess.run(command, check=True, capture_output=True).stdout
    (folder / "e.mtx").write_bytes(out)
    return read_matrix(folder / "e.mtx").values


def assert_product_equals_dctimestep(folder, xml, *, rtol=1e-5):
    T = read_bsdf(xml).transmission_matrix()
    V = random_matrix(7, T.rows.size, 1)
    D = random_matrix(T.columns.size, 146, 2)
    S = random_matrix(146, 5, 3)
    ours = (V @ T @ D @ S).values
    np.testing.assert_allclose(ours, dctimestep(folder, xml, (V, D, S)), rtol=rtol)


def asymmetric_bsdf(partition, *, functions=FUNCTIONS, least=0.0):
    """Different functions without any symmetry."""
    rng = np.random.default_rng(1)
    shape = (len(partition), len(partition))
    return Bsdf(
        {
            ("visible", name): ScatteringMatrix(
                least + rng.random(shape) * 0.2, partition, partition
            )
            for name in functions
        }
    )


@pytest.mark.parametrize("name", ["blinds.xml", "clear.xml", "ven45.xml"])
def test_product_with_a_tutorial_file(tmp_path, shared_data, name):
    path = shared_data / "tutorial_room" / "matrices" / "tmtx" / name
    assert_product_equals_dctimestep(tmp_path, path)


@pytest.mark.parametrize("name", ["venetian_blind.xml", "double_pane.xml"])
def test_product_with_a_bundled_file(tmp_path, name):
    with as_file(files("clerestory") / "demo" / name) as path:
        assert_product_equals_dctimestep(tmp_path, path)


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
@pytest.mark.parametrize("least", [0.0, 0.05])
def test_product_with_a_file_of_ours(tmp_path, basis, least):
    """`least` is diffuse light, which Radiance takes out and adds again."""
    write_bsdf(tmp_path / "t.xml", asymmetric_bsdf(klems(basis), least=least))
    assert_product_equals_dctimestep(tmp_path, tmp_path / "t.xml")


@pytest.mark.parametrize("basis", ["full", "half", "quarter"])
def test_product_with_the_other_side_by_reciprocity(tmp_path, basis):
    bsdf = asymmetric_bsdf(klems(basis), functions=("transmission_back",))
    write_bsdf(tmp_path / "t.xml", bsdf)
    assert_product_equals_dctimestep(tmp_path, tmp_path / "t.xml")


def test_product_with_rings_of_the_files_own(tmp_path):
    path = Path(__file__).parents[1] / "data" / "five_patches.xml"
    assert_product_equals_dctimestep(tmp_path, path)


def test_product_in_colour_to_the_eight_bits_of_radiance(tmp_path):
    """Radiance rounds u'v' of each value to 8 bits with dither: 1 % of a channel."""
    full = klems("full")
    y = 0.02 + np.random.default_rng(4).random((145, 145)) * 0.1
    tables = {"visible": y, "cie-x": 1.05 * y, "cie-z": 0.8 * y}
    bsdf = Bsdf(
        {
            (channel, "transmission_front"): ScatteringMatrix(table, full, full)
            for channel, table in tables.items()
        }
    )
    rgb = bsdf.transmission_matrix().values.mean(axis=(1, 2))
    assert rgb[0] > 1.2 * rgb[2]
    write_bsdf(tmp_path / "t.xml", bsdf)
    assert_product_equals_dctimestep(tmp_path, tmp_path / "t.xml", rtol=0.01)
