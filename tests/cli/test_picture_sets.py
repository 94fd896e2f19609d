"""Sets of pictures as factors of products, and as their results."""

import numpy as np
import pytest
from radiance import run

from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.matrix.axis import unknown_axis
from clerestory.matrix.radiance_format import write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.scene.view import View

VIEW = View(kind="perspective", horizontal=60, vertical=40)


@pytest.fixture
def factors(room):
    """Three pictures of 4 × 6 pixels, three patches lit by two skies."""
    rng = np.random.default_rng(3)
    pictures = rng.uniform(0.1, 2, (3, 4, 6, 3)).astype(np.float32)
    for number, pixels in enumerate(pictures):
        write_picture(Picture(pixels, view=VIEW), room / f"V_{number:03d}.exr")
        write_picture(Picture(pixels, view=VIEW), room / f"V_{number:03d}.hdr")
    sky = rng.uniform(0, 3, (3, 3, 2))
    matrix = TransferMatrix(sky, unknown_axis(3), unknown_axis(2))
    write_matrix(room / "S.smx", matrix, encoding="double")
    return pictures, sky


def test_pictures_are_weighted_and_added(call, room, factors):
    """Pixel by pixel, channel by channel, as the sum over patches says."""
    pictures, sky = factors
    outcome = call("multiply", "V_%03d.exr", "S.smx", "-o", "I_%02d.exr")
    assert outcome.status == 0
    assert outcome.out.startswith("I_%02d.exr: 24 pixels")
    for step in range(2):
        expected = np.einsum("krcx,xk->rcx", pictures, sky[:, :, step])
        found = read_picture(room / f"I_{step:02d}.exr")
        assert np.allclose(found.radiance, expected, rtol=1e-6)
        assert found.view.horizontal == pytest.approx(60)


def test_products_of_pictures_equal_dctimestep(call, room, factors):
    """Within the 8 bits of .hdr, which both programs read and write."""
    assert call("multiply", "V_%03d.hdr", "S.smx", "-o", "I_%d.hdr").status == 0
    run("dctimestep -o R_%d.hdr V_%03d.hdr S.smx", folder=room)
    files = sorted(room.glob("R_*.hdr"))
    assert len(files) == 2
    for step, file in enumerate(files):
        ours = read_picture(room / f"I_{step}.hdr").radiance
        theirs = read_picture(file).radiance
        largest = theirs.max(axis=2, keepdims=True)
        assert (np.abs(ours - theirs) <= largest / 100).all()


def test_one_sky_makes_one_picture_without_number(call, room, factors):
    write_matrix(
        room / "one.vec",
        TransferMatrix(np.ones((3, 3, 1)), unknown_axis(3), unknown_axis(1)),
    )
    assert call("multiply", "V_%03d.hdr", "one.vec", "-o", "sum.hdr").status == 0
    assert read_picture(room / "sum.hdr").rows == 4


@pytest.mark.parametrize(
    ("command", "said"),
    [
        ("multiply V_%03d.hdr S.smx -o I.hdr", "such as in V_%03d.hdr expected"),
        ("multiply V_%s_%d.hdr S.smx -o I.hdr", "one number such as in V_%03d.hdr"),
        ("multiply W_%03d.hdr S.smx -o I.hdr", "W_000.hdr: cannot be read"),
    ],
)
def test_wrong_sets_are_reported_in_one_line(call, factors, command, said):
    outcome = call(*command.split())
    assert outcome.status == 2
    assert said in outcome.err
    assert outcome.err.count("\n") == 1


def test_pictures_of_another_size_are_refused(call, room, factors):
    write_picture(Picture(np.ones((2, 2, 3), dtype=np.float32)), room / "V_001.hdr")
    outcome = call("multiply", "V_%03d.hdr", "S.smx", "-o", "I_%d.hdr")
    assert outcome.status == 2
    assert "V_001.hdr: the picture has 2 × 2 pixels; 6 × 4 expected" in outcome.err
