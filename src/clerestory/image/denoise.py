"""Denoising of ray-traced pictures by a neural network (Intel Open Image Denoise).

A denoised picture is for display, not for photometry: its errors are unknown, and
radiances may be biased near edges. The picture's header records the denoising, and
glare is not evaluated from denoised pictures.

Reference: A. Áfra, Intel Open Image Denoise, 2019–2026, openimagedenoise.org.
"""

import importlib
import importlib.metadata
import importlib.util
from dataclasses import replace

import numpy as np

from clerestory.bands import RGB
from clerestory.errors import ClerestoryError
from clerestory.image.picture import Picture

_MARK = "DENOISED="


def denoise(picture: Picture) -> Picture:
    """Return a denoised picture, with the denoising recorded in its header.

    Raises
    ------
    ClerestoryError : the denoiser is not installed
    """
    if importlib.util.find_spec("mitsuba_oidn") is None:
        raise ClerestoryError(
            "the denoiser is not installed; run `pip install clerestory[denoise]`"
        )
    network = importlib.import_module("mitsuba_oidn")
    version = importlib.metadata.version("mitsuba-oidn")
    values = np.ascontiguousarray(picture.rgb, dtype=np.float32)
    smoothed = np.asarray(network.denoise(values, hdr=True), dtype=np.float32)
    line = f"{_MARK} Open Image Denoise by mitsuba-oidn {version}; for the eye only"
    return replace(
        picture,
        radiance=np.maximum(smoothed, 0),
        header=(*picture.header, line),
        bands=RGB,
    )


def is_denoised(picture: Picture) -> bool:
    """Whether the header of a picture records a denoising."""
    return any(line.strip().startswith(_MARK) for line in picture.header)
