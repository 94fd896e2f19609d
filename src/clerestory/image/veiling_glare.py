"""Veiling glare by intraocular scattering over the whole view."""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32
from scipy.ndimage import map_coordinates

from clerestory.image.arithmetic import reduce
from clerestory.image.picture import Picture
from clerestory.scene.projection import PROJECTIONS
from clerestory.scene.view import View

# Fraction of luminous flux scattered in the eye: Moon and Spencer (1945), as in Ward
# Larson et al. (1997), eq. 8, and pcond
_SCATTERED = 0.08

# Width of the fovea [rad]; width assumed for a picture without a view [°]
_FOVEA = np.radians(1.0)
_WIDTH = 40.0

# Largest number of pairs of view samples in memory; largest number of view samples
_PAIRS = 1 << 22
_MOST_SAMPLES = 8192


class FovealView(NamedTuple):
    """View divided into `columns` × `rows` samples, one degree wide at the centre."""

    view: View
    columns: int
    rows: int


def foveal_view(picture: Picture) -> FovealView:
    """Return the view of a picture, divided into samples of one degree.

    A perspective 40° wide on the longer side is assumed if the picture has no view, a
    parallel projection, or a view narrower than 5°.
    """
    view = picture.view
    if (
        view is None
        or view.kind == "parallel"
        or min(view.horizontal, view.vertical) < 5
    ):
        shape = np.array([picture.columns, picture.pixel_aspect * picture.rows])
        half = np.tan(np.radians(_WIDTH) / 2) * shape / shape.max()
        width, height = np.degrees(2 * np.arctan(half))
        view = View(horizontal=float(width), vertical=float(height))
    size = PROJECTIONS[view.kind].extent(view.horizontal, view.vertical)
    columns, rows = (max(int(2 * half / _FOVEA + 0.5), 2) for half in size)
    return FovealView(view, columns, rows)


def with_veil(picture: Picture) -> Picture:
    """Return a picture as imaged on the retina, with veiling luminance added.

    8 % of the luminous flux is scattered over the view in proportion to cos θ / θ²,
    where θ is the angle to the light source; total flux is approximately conserved.
    Light sources are averages over one degree, or two degrees in a fisheye view.
    Source: G. Ward Larson et al. (1997), section 5.1, see `visibility_matching`.
    """
    fovea = foveal_view(picture)
    coarser = max(np.sqrt(fovea.columns * fovea.rows / _MOST_SAMPLES), 1)
    columns = min(int(fovea.columns / coarser), picture.columns)
    rows = min(int(fovea.rows / coarser), picture.rows)
    samples = reduce(picture, columns=columns, rows=rows).radiance
    direction = fovea.view.rays(columns, rows).direction.reshape(-1, 3)
    veil = _scatter(direction.astype(np.float32), samples.reshape(rows * columns, -1))
    veil = veil.reshape(samples.shape)
    # Linear interpolation between samples, constant beyond the outermost samples
    axes = [
        (np.arange(fine) + 0.5) / fine * coarse - 0.5
        for fine, coarse in ((picture.rows, rows), (picture.columns, columns))
    ]
    place = np.stack(np.meshgrid(*axes, indexing="ij"))
    bands = np.moveaxis(veil, -1, 0)
    fine = [map_coordinates(band, place, order=1, mode="nearest") for band in bands]
    seen = (1 - _SCATTERED) * picture.radiance + _SCATTERED * np.stack(fine, axis=-1)
    return replace(picture, radiance=seen.astype(np.float32))


def _scatter(
    direction: Float32[np.ndarray, "samples 3"],
    radiance: Float32[np.ndarray, "samples band"],
) -> Float32[np.ndarray, "samples band"]:
    # Mean radiance of all other samples, weighted by cos θ / θ², θ² ≈ 2 (1 − cos θ)
    veil = np.zeros_like(radiance)
    count = max(_PAIRS // len(direction), 1)
    for start in range(0, len(direction), count):
        here = slice(start, start + count)
        cosine = direction[here] @ direction.T
        apart = np.maximum(1 - cosine, 1e-7)
        weight = np.where(cosine > 0, np.maximum(cosine, 0) / (2 * apart), 0)
        own = np.arange(len(weight))
        weight[own, start + own] = 0
        total = np.maximum(weight.sum(axis=1, keepdims=True), 1e-12)
        veil[here] = weight @ radiance / total
    return veil
