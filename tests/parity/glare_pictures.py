"""Pictures for the comparison of glare with evalglare, made from a number each."""

import numpy as np

from clerestory.image.picture import Picture
from clerestory.radiance.view_text import parse_view
from clerestory.scene.view import View

VIEWS = (
    "-vta -vd 0 1 0 -vu 0 0 1 -vh 180 -vv 180",
    "-vth -vd 0.6 0.8 0 -vu 0 0 1 -vh 180 -vv 180",
    "-vtv -vd 1 0 0 -vu 0 0 1 -vh 100 -vv 80",
    "-vts -vd 0 1 0 -vu 0 0 1 -vh 110 -vv 110",
    "-vtc -vd 0 1 0 -vu 0 0 1 -vh 170 -vv 80",
    "-vta -vd 0 1 -.4 -vu 0 0 1 -vh 180 -vv 180",
    "-vta -vd 0 1 0 -vu 0 0 1 -vh 90 -vv 60 -vs .3",
    "-vta -vd 0 1 0 -vu 0 1 1 -vh 186 -vv 186",
)

KINDS = ("windows", "speckles", "slats", "suns", "blobs")


def synthetic_picture(number: int, *, columns: int = 160) -> Picture:
    """Return a picture of a room with bright things in it; numbers differ in all."""
    rng = np.random.default_rng(number)
    view = parse_view(VIEWS[number % len(VIEWS)])
    kind = KINDS[number // len(VIEWS) % len(KINDS)]
    width, height = view.size_for(columns)
    luminance = _room(rng, height, width)
    globals()[f"_{kind}"](rng, luminance)
    grey = (luminance / 179).astype(np.float32)
    return Picture(np.repeat(grey[..., None], 3, axis=2), view=_seen(view))


def _seen(view: View) -> View:
    return view


def _room(rng, height, width):
    row, column = np.mgrid[:height, :width] / max(height, width)
    slope = rng.uniform(-1, 1, 2)
    level = 10 ** rng.uniform(1.5, 2.8)
    room = level * (1.2 + 0.5 * slope[0] * row + 0.5 * slope[1] * column)
    return room * rng.uniform(0.9, 1.1, (height, width))


def _windows(rng, luminance):
    height, width = luminance.shape
    for _ in range(rng.integers(1, 7)):
        top, left = rng.integers(0, height - 4), rng.integers(0, width - 4)
        tall, wide = rng.integers(2, height // 2), rng.integers(2, width // 3)
        level = 10 ** rng.uniform(3.2, 4.2)
        luminance[top : top + tall, left : left + wide] = level


def _speckles(rng, luminance):
    share = 10 ** rng.uniform(-3.5, -1.8)
    bright = rng.random(luminance.shape) < share
    luminance[bright] = 10 ** rng.uniform(3.0, 5.2, int(bright.sum()))


def _slats(rng, luminance):
    height, width = luminance.shape
    period = int(rng.integers(4, 24))
    thick = int(rng.integers(1, period))
    rows = np.arange(height) % period < thick
    if rng.random() < 0.5:
        luminance[np.ix_(rows, np.arange(width // 4, width // 2))] = 6000
    else:
        columns = np.arange(width) % period < thick
        luminance[np.ix_(np.arange(height // 5, height // 2), columns)] = 4000


def _suns(rng, luminance):
    _windows(rng, luminance)
    height, width = luminance.shape
    row, column = np.mgrid[:height, :width]
    for _ in range(rng.integers(1, 5)):
        at = rng.uniform(0, height), rng.uniform(0, width)
        near = np.hypot(row - at[0], column - at[1]) < rng.uniform(0.6, 4)
        luminance[near] = 10 ** rng.uniform(4.6, 7)


def _blobs(rng, luminance):
    noise = rng.standard_normal(luminance.shape)
    power = np.fft.fft2(noise)
    frequency = np.hypot(*np.meshgrid(*(np.fft.fftfreq(n) for n in noise.shape[::-1])))
    smooth = np.fft.ifft2(power * np.exp(-((frequency * rng.uniform(8, 30)) ** 2))).real
    level = np.quantile(smooth, rng.uniform(0.7, 0.99))
    luminance[smooth > level] = 10 ** rng.uniform(3.4, 4.9)
    luminance[smooth > np.quantile(smooth, 0.999)] = 80_000
