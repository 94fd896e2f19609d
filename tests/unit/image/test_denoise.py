"""Denoised pictures are nearer to the truth than noisy ones, and say what they are."""

import importlib.util

import numpy as np
import pytest

from clerestory.errors import ClerestoryError
from clerestory.image.denoise import denoise, is_denoised
from clerestory.image.picture import Picture
from clerestory.image.radiance_hdr import read_radiance, write_radiance
from clerestory.scene.view import View


def noisy_and_true(side=96):
    """Waves of light, and the same with the noise of four paths a pixel."""
    y, x = np.mgrid[:side, :side] / side
    waves = 1 + 0.8 * np.sin(9 * x) * np.cos(7 * y)
    true = waves[..., None] * np.array([3.0, 2.0, 1.0])
    noise = np.random.default_rng(1).gamma(4, 1 / 4, true.shape)
    return (true * noise).astype(np.float32), true


@pytest.fixture
def network():
    return pytest.importorskip("mitsuba_oidn", reason="the extra `denoise`")


def test_noise_is_smoothed_and_the_mean_kept(network):
    noisy, true = noisy_and_true()
    smooth = denoise(Picture(noisy)).radiance
    before, after = (np.sqrt(np.mean((p - true) ** 2)) for p in (noisy, smooth))
    assert after < 0.25 * before
    # Sums of pixels shift by less than what the noise itself leaves uncertain, and 2 %
    assert smooth.mean() == pytest.approx(noisy.mean(), rel=0.02)


def test_the_header_is_complete_and_read_back(network, tmp_path):
    picture = Picture(noisy_and_true()[0], view=View(), quantity="irradiance")
    made = denoise(picture)
    assert is_denoised(made)
    assert not is_denoised(picture)
    assert made.quantity == "irradiance"
    assert made.view is picture.view
    write_radiance(made, tmp_path / "a.hdr")
    assert is_denoised(read_radiance(tmp_path / "a.hdr"))


def test_without_the_extra_one_line_says_what_to_install(monkeypatch):
    monkeypatch.setattr(importlib.util, "find_spec", lambda name: None)
    with pytest.raises(ClerestoryError, match=r"pip install clerestory\[denoise\]"):
        denoise(Picture(np.ones((2, 2, 3), dtype=np.float32)))
