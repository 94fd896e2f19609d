"""Annual glare at a view point of a scene with glazing, by the two-phase method.

The windows are surfaces of the scene, with their materials: clear or scattering glass,
behind which the sun may be mirrored by façades. The sphere is divided into equal cells,
whose radiance is traced as that of pixels (`phases.sky_views`); the sun's disc is
evaluated apart.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Unpack

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import require, within
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.glare.cell_luminance import cell_luminance
from clerestory.glare.dgp_error import DgpModel, limited
from clerestory.glare.eye_directions import SUN_SOLID_ANGLE, SunDisc
from clerestory.glare.index_settings import EVALGLARE
from clerestory.glare.point_glare import point_glare
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.sphere_samples import SphereSamples, regular_samples
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    equation_bands,
)
from clerestory.phases.methods import METHODS
from clerestory.phases.picture_series import PixelSeries
from clerestory.phases.sky_views import (
    sky_view_matrices,
    sun_disc,
    sun_view_coefficients,
)
from clerestory.scene.model import Scene
from clerestory.scene.view import View

if TYPE_CHECKING:
    import xarray as xr

# Default number of paths per cell, and per cell and sun
_SAMPLES, _SUN_SAMPLES = 4096, 8

# Level of the cells by default: 2,048 cells in a hemisphere, 3° wide
_LEVEL = 6

# Cells this far behind a view have directions that it sees (sine)
_BEHIND = 0.1

# Offset of the seed of sunlight
_SUN = 0x10000


def glazed_view_glare(
    scene: Scene,
    views: Sequence[View],
    *,
    skies: Skies,
    level: int = _LEVEL,
    sun_samples: int = _SUN_SAMPLES,
    quantities: Collection[str] = ("dgp", "illuminance"),
    **keywords: Unpack[EffortKeywords],
) -> "xr.Dataset":
    """Return glare indices of views from one point, over time.

    Parameters
    ----------
    scene : the room, its glazing and what surrounds it, without a sky
    views : views from one point, of which line of sight and up vector define the eye
    skies : S, S_ds and S_sun, with the time steps
    level : size of the cells; one more divides each cell in four
    samples : number of paths per cell
    sun_samples : number of paths per cell and sun
    quantities : names of indices and quantities, as of `point_glare`

    The other parameters are those of `view_matrix`.

    Returns
    -------
    dataset over (view, time), NaN in dark time steps; with "dgp", also "dgp_error", its
    standard error due to the random paths

    Raises
    ------
    InputError : no views, views from different points, skies without S_ds or S_sun, or
        a number out of range

    Examples
    --------
    >>> import clerestory as cl
    >>> from clerestory.sky.sun_matrix import sun_matrix
    >>> weather = cl.Weather(
    ...     place="Oakland", latitude_deg=37.7, longitude_deg=-122.2, elevation=0.0,
    ...     utc_offset_hours=-8.0, times=np.array(["2023-03-21T12:30"], "M8[m]"),
    ...     step_minutes=60.0, direct_normal=np.array([600.0]),
    ...     diffuse_horizontal=np.array([150.0]), source="an example"
    ... )
    >>> S, S_ds = (
    ...     cl.sky_matrix(weather, subdivision=1, include=part)
    ...     for part in ("all", "sun")
    ... )
    >>> skies = Skies(S, S_ds, sun_matrix(weather))
    >>> south = View("angular", direction=np.array([0, -1.0, 0]),
    ...              horizontal=180, vertical=180)
    >>> found = cl.glazed_view_glare(
    ...     cl.Scene(), [south], skies=skies, level=4, samples=16, device="cpu")
    >>> found.dgp.values.tolist()
    [[1.0]]
    """
    effort = effort_of(glazed_view_glare, keywords, default=Goal(_SAMPLES))
    within(level, "level of the cells", least=1, most=10)
    require(views, "no views; at least one expected")
    place = views[0].position
    require(
        all(np.allclose(view.position, place) for view in views),
        "views from different points; views from one point expected",
    )
    message = "skies without S_ds or S_sun; both expected for the direct sun"
    require(skies.sun is not None and skies.suns is not None, message)
    cells = _cells_ahead(views, level)
    point = _GlazedPoint(scene, tuple(views), cells, skies)
    return point.glare(point.matrices(effort, sun_samples), quantities, effort)


def _cells_ahead(views: Sequence[View], level: int) -> SphereSamples:
    # Cells, with their directions in the middle, of which some view sees a part
    cells = regular_samples(level).centred()
    looks = np.array([view.direction for view in views])
    return cells.select((cells.direction @ looks.T).max(axis=1) > -_BEHIND)


@dataclass(frozen=True, eq=False)
class _GlazedPoint:
    scene: Scene
    views: tuple[View, ...]
    cells: SphereSamples
    skies: Skies

    def matrices(self, effort: Effort, sun_samples: int) -> WindowMatrices:
        """Trace C, C_d and C_ds."""
        assert self.skies.suns is not None
        cells = self.cells.cells(self.views[0].position)
        subdivision = self.skies.whole.partition.subdivision
        C, C_d = sky_view_matrices(
            self.scene, cells, subdivision=subdivision, effort=effort
        )
        own = replace(
            effort,
            samples=sun_samples,
            relative_error=None,
            bounces=None,
            seed=(effort.seed + _SUN) % 2**32,
        )
        suns = self.skies.suns.directions
        C_ds = sun_view_coefficients(self.scene, cells, suns=suns, effort=own)
        return WindowMatrices(*(MatrixChain((part,)) for part in (C, C_d, C_ds)))

    def glare(
        self, matrices: WindowMatrices, quantities: Collection[str], effort: Effort
    ) -> "xr.Dataset":
        """Return the glare indices of the views."""
        times = self.skies.times
        lit = np.flatnonzero(self.skies.whole.diffuse.max(axis=0) > 0)
        sun = self._disc(matrices, lit, effort)
        light, error = self._luminance(matrices, lit, sun)
        found = point_glare(
            self.cells,
            light,
            self.views,
            sun=sun,
            times=times[lit],
            quantities=quantities,
        )
        if "dgp" in quantities:
            found["dgp_error"] = ("view", "time"), error, {"units": "1"}
        return found.reindex(time=times)

    def _disc(
        self, matrices: WindowMatrices, steps: Int[np.ndarray, " step"], effort: Effort
    ) -> SunDisc:
        assert self.skies.suns is not None
        suns, place = self.skies.suns, self.views[0].position
        share, passed = sun_disc(
            self.scene, place, suns.directions, device=effort.device
        )
        direction = np.tile([0.0, 0.0, 1.0], (len(steps), 1))
        level, angle = np.zeros(len(steps)), np.zeros(len(steps))
        normal = suns.direct_normal[:, steps].tocoo()
        sun, step = normal.coords
        efficacy = equation_bands([matrices], self.skies).weights.sum()
        direction[step] = suns.directions[sun]
        level[step] = normal.data * passed[sun] * efficacy / SUN_SOLID_ANGLE
        angle[step] = SUN_SOLID_ANGLE * share[sun]
        return SunDisc(direction, level, angle)

    def _luminance(
        self, matrices: WindowMatrices, steps: Int[np.ndarray, " step"], sun: SunDisc
    ) -> tuple[Float[np.ndarray, "cell step"], Float[np.ndarray, "view step"]]:
        # Luminance of the cells, and standard error of DGP due to the random paths
        model = DgpModel(self.cells, self.views, Refinement().threshold, EVALGLARE)
        series = PixelSeries(
            [matrices],
            METHODS["2-phase"].terms(corrected=True),
            self.skies.select(steps),
            None,
            equation_bands([matrices], self.skies).weights[None],
            self.cells.count,
            errors=True,
        )
        light, variance, value = cell_luminance(series, model, sun)
        return light, limited(np.sqrt(variance), value)
