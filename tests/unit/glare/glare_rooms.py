"""Rooms with bright things in known places, seen by a fisheye."""

import numpy as np

from clerestory.glare.glare_view import glare_view
from clerestory.image.picture import Picture
from clerestory.scene.view import View

FISHEYE = View(kind="angular", horizontal=180, vertical=180)
SIZE = 180


def eye():
    return glare_view(FISHEYE, SIZE, SIZE)


def room(level=100.0):
    return np.full((SIZE, SIZE), float(level))


def picture(luminance, view=FISHEYE):
    grey = (np.asarray(luminance) / 179).astype(np.float32)
    return Picture(np.repeat(grey[..., None], 3, axis=2), view=view)
