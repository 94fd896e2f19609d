"""`clerestory multiply` against Radiance's dctimestep, on the same files."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.matrix.axis import unknown_axis
from clerestory.matrix.radiance_format import read_matrix, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix

pyradiance = pytest.importorskip("pyradiance")


def write(name, values):
    rows, columns = (unknown_axis(size) for size in values.shape[1:])
    write_matrix(name, TransferMatrix(values, rows, columns), encoding="float")


@pytest.mark.parametrize("basis", ["full", "quarter"])
def test_four_factors_give_what_dctimestep_gives(call, room, basis):
    """An asymmetric BSDF: a transposed or turned T would show."""
    rng = np.random.default_rng(11)
    partition = klems(basis)
    count = len(partition)
    bsdf = rng.random((count, count)) / np.pi
    part = ScatteringMatrix(bsdf * 0.3, partition, partition)
    write_bsdf("random.xml", Bsdf({("visible", "transmission_front"): part}))
    write("V.mtx", rng.random((3, 7, count)))
    write("D.mtx", rng.random((3, count, 146)))
    write("S.smx", rng.random((3, 146, 9)) ** 4 * 1e4)

    home = Path(pyradiance.__file__).parent
    words = [
        home / "bin" / "dctimestep",
        "-of",
        "V.mtx",
        "random.xml",
        "D.mtx",
        "S.smx",
    ]
    environment = {**os.environ, "RAYPATH": str(home / "lib")}
    done = subprocess.run(words, capture_output=True, env=environment, check=True)
    Path("R.mtx").write_bytes(done.stdout)

    factors = "V.mtx random.xml D.mtx S.smx"
    assert call(*f"multiply {factors} -o E.mtx".split()).status == 0
    np.testing.assert_allclose(
        read_matrix("E.mtx").values, read_matrix("R.mtx").values, rtol=1e-5
    )
