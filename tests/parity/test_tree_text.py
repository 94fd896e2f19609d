"""The short text of tensor trees: its size, and its values as Radiance reads them."""

import subprocess
import sys

import numpy as np
import pytest
from bsdf_ripple import angles_deg, directions, library, load

from clerestory.bsdf.patch_symmetry import flux_table, mismatch
from clerestory.bsdf.resample import to_trees
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems


@pytest.fixture(scope="module")
def blind(shared_data):
    """A blind of WINDOW, with visible and solar data of both sides."""
    return shared_data / "bsdf" / "pyradiance_tutorial" / "ven45.xml"


def convert(source, output, *words):
    code = "import sys; from clerestory.cli.main import main; sys.exit(main())"
    command = [sys.executable, "-c", code, "bsdf", "convert", str(source)]
    command += ["--to", "tree", "-o", str(output), *words]
    subprocess.run(command, check=True, capture_output=True)


def test_a_converted_blind_is_a_fifth_of_its_full_text(blind, tmp_path):
    """Eight functions of a million cells were 91 MB with seven digits."""
    convert(blind, tmp_path / "tree.xml")
    assert (tmp_path / "tree.xml").stat().st_size < 18e6
    before, after = read_bsdf(blind), read_bsdf(tmp_path / "tree.xml")
    full = to_trees(before)
    for channel, name in before.functions:
        one, other, exact = (
            bsdf.function(name, channel=channel, partition=klems("full"))
            for bsdf in (before, after, full)
        )
        assert other.diffuse() == pytest.approx(one.diffuse(), rel=3e-5)
        # Conversion to cells moves up to 30 % of the light to other patches, mergers
        # less than that
        converted = mismatch(flux_table(one), flux_table(exact))
        merged = mismatch(flux_table(exact), flux_table(other))
        assert merged < min(0.03, 0.8 * converted)


@pytest.mark.parametrize("digits", [None, 5])
def test_radiance_reads_the_values_of_the_text(blind, tmp_path, digits):
    """Equal to the values that we hold, to Radiance's ripple and the digits."""
    trees = to_trees(read_bsdf(blind), halvings=4, reduction=75)
    path = tmp_path / f"digits_{digits}.xml"
    write_bsdf(path, trees, digits=digits)
    text = path.read_text()
    assert " 0." not in text[text.index("<ScatteringData>") :]
    data = load(path)
    incident, leaving = directions(800, 1), directions(800, 2)
    theirs = np.array(
        [
            library.query(data, *i, *o)[1]
            for i, o in zip(angles_deg(incident), angles_deg(leaving), strict=True)
        ]
    )
    ours = trees.evaluate(incident, leaving)
    assert np.ptp(ours) > 0.05
    error = 3.1e-4 if digits is None else 3.7e-4
    np.testing.assert_allclose(theirs, ours, rtol=error, atol=2e-6)
