"""Tone mapping as human vision against Radiance's pcond."""

import numpy as np
import pytest
from radiance import run

from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture
from clerestory.image.radiance_hdr import write_radiance
from clerestory.image.visibility_matching import human_vision
from clerestory.scene.view import View

FILES = [
    pytest.param("raytools_desk_render.hdr", marks=pytest.mark.slow),
    "evalglare_testimage_ISE2003.hdr",
]
OPTIONS = {
    "": {"contrast_sensitivity": False, "colour_loss": False},
    "-s": {"colour_loss": False},
    "-s -c": {},
}


def shown_by_pcond(options, path, folder):
    """Display values; where pcond maps linearly, its output has an exposure instead."""
    run(f"pcond {options} {path} > c.hdr", folder=folder)
    text = (folder / "c.hdr").read_bytes().partition(b"\n\n")[0].decode("latin-1")
    told = [x for x in text.split("\n") if x.startswith("EXPOSURE")]
    exposure = float(told[-1].partition("=")[2]) if told else 1.0
    return read_picture(folder / "c.hdr").radiance * exposure


@pytest.mark.parametrize("name", FILES)
@pytest.mark.parametrize("options", OPTIONS)
def test_pictures_look_as_pcond_shows_them(name, options, shared_data, tmp_path):
    """Pcond draws its histogram from random pixels and stores 8 bits a channel."""
    path = shared_data / "hdr" / name
    theirs = shown_by_pcond(options, path, tmp_path)[..., 1]
    ours = human_vision(read_picture(path), **OPTIONS[options])[..., 1]
    difference = (ours - theirs)[theirs > 1e-3]
    assert np.sqrt(np.mean(difference**2)) < 0.005
    assert np.abs(difference).max() < 0.02


@pytest.mark.parametrize("options", OPTIONS)
def test_dim_scenes_look_as_pcond_shows_them(options, tmp_path):
    """Moonlit to lamplit, coloured: rods and cones."""
    rng = np.random.default_rng(8)
    levels = np.geomspace(1e-4, 10, 240)[None, :, None]
    values = levels * rng.uniform(0.5, 1.5, (200, 240, 3))
    write_radiance(
        Picture(values.astype(np.float32), view=View(horizontal=60, vertical=50)),
        tmp_path / "a.hdr",
    )
    theirs = shown_by_pcond(options, "a.hdr", tmp_path)
    ours = human_vision(read_picture(tmp_path / "a.hdr"), **OPTIONS[options])
    difference = (ours - theirs)[theirs > 1e-3]
    assert np.sqrt(np.mean(difference**2)) < 0.01
