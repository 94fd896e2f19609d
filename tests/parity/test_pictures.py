"""Pictures read and written against Radiance's own programs."""

import numpy as np
import pytest
from radiance import run

from clerestory.image.arithmetic import crop, reduce, weighted_sum
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture
from clerestory.image.radiance_hdr import write_radiance
from clerestory.scene.view import View

FILES = ["raytools_desk_render.hdr", "evalglare_testimage_ISE2003.hdr"]


def values_of(command, folder, shape):
    """RGB that pvalue prints, rows from the top."""
    numbers = np.array(run(command, folder=folder).split(), dtype=float)
    return numbers.reshape(*shape, 3)


def noisy_picture(rows=31, columns=47):
    rng = np.random.default_rng(3)
    values = np.exp(rng.normal(0, 3, (rows, columns, 1))) * rng.uniform(
        0.6, 1.4, (rows, columns, 3)
    )
    values[5:20, 4:40] = 2.5  # something for the run-length code
    values[:, 30] = 0
    return Picture(values.astype(np.float32), view=View(horizontal=60))


@pytest.mark.parametrize("name", FILES)
def test_shared_pictures_have_the_values_of_pvalue(name, shared_data, tmp_path):
    picture = read_picture(shared_data / "hdr" / name)
    file = shared_data / "hdr" / name
    run(f"pcompos -x 50 -y 50 {file} -300 -400 > cut.hdr", folder=tmp_path)
    theirs = values_of("pvalue -o -h -H -d cut.hdr", tmp_path, (50, 50))
    ours = picture.radiance[picture.rows - 450 : picture.rows - 400, 300:350]
    assert np.allclose(ours, theirs, rtol=1e-3)


def test_pvalue_reads_what_we_write(tmp_path):
    picture = noisy_picture()
    write_radiance(picture, tmp_path / "a.hdr", exposure=0.25)
    theirs = values_of("pvalue -o -h -H -d a.hdr", tmp_path, (31, 47))
    ours = read_picture(tmp_path / "a.hdr").radiance
    assert np.allclose(ours, theirs, rtol=2e-3, atol=1e-9)


def test_radiance_writes_the_same_bytes_for_the_same_values(tmp_path):
    """Pixels we wrote, decoded and encoded again by pcomb, do not change."""
    write_radiance(noisy_picture(), tmp_path / "a.hdr")
    run("pcomb a.hdr > b.hdr", folder=tmp_path)
    for name in "ab":
        run(f"pvalue -o -h -H -d {name}.hdr > {name}.txt", folder=tmp_path)
    assert (tmp_path / "a.txt").read_text() == (tmp_path / "b.txt").read_text()


def test_our_reader_reads_every_code_that_radiance_writes(tmp_path):
    write_radiance(noisy_picture(), tmp_path / "a.hdr")
    ours = read_picture(tmp_path / "a.hdr").radiance
    run("ra_rgbe a.hdr flat.hdr && ra_rgbe -r a.hdr run.hdr", folder=tmp_path)
    for name in ("flat", "run"):
        assert np.array_equal(read_picture(tmp_path / f"{name}.hdr").radiance, ours)


@pytest.mark.parametrize("command", ["pflip -h", "pflip -v", "protate", "protate -r"])
def test_other_orders_of_pixels_show_the_same_picture(command, tmp_path):
    """These programs reorder pixels and say so in the resolution line."""
    write_radiance(noisy_picture(), tmp_path / "a.hdr")
    run(f"{command} a.hdr > b.hdr", folder=tmp_path)
    expected = read_picture(tmp_path / "a.hdr").radiance
    assert np.array_equal(read_picture(tmp_path / "b.hdr").radiance, expected)


@pytest.mark.parametrize(
    ("command", "turn"),
    [
        ("pflip -c -h", lambda a: a[:, ::-1]),
        ("pflip -c -v", lambda a: a[::-1]),
        ("protate -c", lambda a: np.rot90(a, -1)),
        ("protate -c -r", np.rot90),
    ],
)
def test_turned_pictures_are_turned(command, turn, tmp_path):
    write_radiance(noisy_picture(), tmp_path / "a.hdr")
    run(f"{command} a.hdr > b.hdr", folder=tmp_path)
    expected = turn(read_picture(tmp_path / "a.hdr").radiance)
    assert np.array_equal(read_picture(tmp_path / "b.hdr").radiance, expected)


def test_xyz_pictures_both_ways(tmp_path):
    picture = noisy_picture()
    write_radiance(picture, tmp_path / "rgb.hdr")
    run("ra_xyze rgb.hdr theirs.hdr", folder=tmp_path)
    largest = picture.radiance.max(axis=2, keepdims=True)
    theirs = read_picture(tmp_path / "theirs.hdr").radiance
    assert (np.abs(theirs - picture.radiance) <= 0.02 * largest).all()
    # And what we write, Radiance reads
    write_radiance(picture, tmp_path / "xyz.hdr", xyz=True)
    run("ra_xyze -r -o xyz.hdr back.hdr", folder=tmp_path)
    back = read_picture(tmp_path / "back.hdr").radiance
    assert (np.abs(back - picture.radiance) <= 0.02 * largest).all()


def test_other_primaries_are_those_of_ra_xyze(tmp_path):
    """Pixels that ra_xyze converts to D65 primaries have the same colour."""
    picture = noisy_picture()
    write_radiance(picture, tmp_path / "a.hdr")
    primaries = ".64 .33 .3 .6 .15 .06 .3127 .329"
    run(f"ra_xyze -r -p {primaries} a.hdr b.hdr", folder=tmp_path)
    largest = picture.radiance.max(axis=2, keepdims=True)
    again = read_picture(tmp_path / "b.hdr").radiance
    # Colours beyond the other gamut were cut by ra_xyze: compare those within
    within = (np.abs(again - picture.radiance) <= 0.02 * largest).all(axis=2)
    assert within.mean() > 0.8


def test_radiance_finds_view_exposure_and_size(tmp_path):
    picture = noisy_picture()
    write_radiance(picture, tmp_path / "a.hdr", exposure=0.5)
    assert "-Y 31 +X 47" in run("getinfo -d a.hdr", folder=tmp_path)
    assert "-vh 60" in run("getinfo a.hdr", folder=tmp_path)
    rays = run("vwrays a.hdr", folder=tmp_path)
    first = np.array(rays.split("\n")[0].split(), dtype=float)[3:]
    assert np.allclose(first, picture.view.rays(47, 31).direction[0, 0], atol=1e-5)


@pytest.mark.parametrize("factor", [2, 3, 5])
def test_reduction_is_that_of_pfilt(factor, tmp_path):
    picture = noisy_picture(rows=30, columns=60)
    write_radiance(picture, tmp_path / "a.hdr")
    run(f"pfilt -1 -b -x /{factor} -y /{factor} a.hdr > b.hdr", folder=tmp_path)
    theirs = read_picture(tmp_path / "b.hdr").radiance
    source = read_picture(tmp_path / "a.hdr")
    ours = reduce(source, columns=60 // factor, rows=30 // factor).radiance
    # pfilt's result is kept to 1/256 of the largest component
    largest = theirs.max(axis=2, keepdims=True)
    assert (np.abs(ours - theirs) <= largest / 256).all()


def test_weighted_sums_are_those_of_pcomb(tmp_path):
    for name, seed in (("a", 3), ("b", 4)):
        rng = np.random.default_rng(seed)
        values = rng.uniform(1, 9, (20, 30, 3)).astype(np.float32)
        write_radiance(Picture(values), tmp_path / f"{name}.hdr")
    run("pcomb -s 2 a.hdr -s -.1 b.hdr > c.hdr", folder=tmp_path)
    theirs = read_picture(tmp_path / "c.hdr").radiance
    pictures = [read_picture(tmp_path / f"{name}.hdr") for name in "ab"]
    ours = weighted_sum(pictures, [2, -0.1]).radiance
    assert (np.abs(ours - theirs) <= theirs.max(axis=2, keepdims=True) / 256).all()


def test_a_cut_out_s_view_means_what_vwrays_says(tmp_path):
    view = View(kind="angular", horizontal=180, vertical=180)
    values = np.ones((40, 40, 3), dtype=np.float32)
    part = crop(Picture(values, view=view), left=5, top=20, columns=10, rows=12)
    write_radiance(part, tmp_path / "part.hdr")
    write_radiance(Picture(values, view=view), tmp_path / "whole.hdr")
    theirs = [
        np.array(run(f"vwrays {name}.hdr", folder=tmp_path).split(), float)
        for name in ("part", "whole")
    ]
    whole = theirs[1].reshape(40, 40, 6)[20:32, 5:15]
    assert np.allclose(theirs[0].reshape(12, 10, 6), whole, atol=2e-5)
