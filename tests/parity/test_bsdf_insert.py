"""A layer inserted into a template is accepted by dctimestep, and gives its data."""

import subprocess
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.xml_insertion import insert_blocks
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.matrix.axis import unknown_axis
from clerestory.matrix.radiance_format import read_matrix, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix

pyradiance = pytest.importorskip("pyradiance")
BIN = Path(pyradiance.__file__).parent / "bin"


def test_dctimestep_takes_genbsdf_data_in_a_template_of_window(shared_data, tmp_path):
    """metalGrate of genBSDF in WINDOW's clear pane, with NIR from its visible."""
    folder = shared_data / "bsdf" / "pyradiance_tutorial"
    source, out = folder / "metalGrate.xml", tmp_path / "out.xml"
    insert_blocks(source, folder / "clear.xml", out)
    assert read_bsdf(out).product.name == read_bsdf(folder / "clear.xml").product.name

    rng = np.random.default_rng(5)
    T = read_bsdf(source).transmission_matrix()
    factors = [
        TransferMatrix(
            rng.random((3, rows, columns)), *map(unknown_axis, (rows, columns))
        )
        for rows, columns in ((4, 145), (145, 146), (146, 3))
    ]
    names = [tmp_path / f"{name}.mtx" for name in "vds"]
    for name, factor in zip(names, factors, strict=True):
        write_matrix(name, factor, encoding="double")
    command = [BIN / "dctimestep", "-od", names[0], out, *names[1:]]
    (tmp_path / "e.mtx").write_bytes(
        subprocess.run(command, check=True, capture_output=True).stdout
    )
    V, D, S = factors
    theirs = read_matrix(tmp_path / "e.mtx").values
    np.testing.assert_allclose((V @ T @ D @ S).values, theirs, rtol=1e-5)
