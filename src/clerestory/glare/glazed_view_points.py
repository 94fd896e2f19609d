"""Annual glare at a view point of a scene with glazing, by the two-phase method.

The windows are surfaces of the scene, with their materials: clear or scattering glass,
behind which the sun may be mirrored by façades. The sphere is divided into cells, fine
where DGP depends on it, whose radiance is traced as that of pixels
(`phases.sky_views`); the sun's disc is evaluated apart.
"""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Unpack

import numpy as np
from jaxtyping import Bool
from scipy.sparse import csc_array

from clerestory.array_types import Vector
from clerestory.checks import require
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.glare.cell_luminance import STEPS, cell_luminance
from clerestory.glare.dgp_error import DgpModel, Light, limited
from clerestory.glare.eye_directions import SUN_SOLID_ANGLE, SunDisc
from clerestory.glare.point_glare import point_glare
from clerestory.glare.representative_steps import representative_steps
from clerestory.glare.sphere_refinement import (
    Refinement,
    sample_sphere,
    sampling_error,
)
from clerestory.glare.sphere_samples import SphereSamples
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
SAMPLES, SUN_SAMPLES = 4096, 8

# Cells by default: those of the first round are 3° wide
_REFINEMENT = Refinement(first=6)

# Numbers of paths per cell, and per cell and sun, while the cells are chosen
_TRIAL, _SUN_TRIAL = 256, 2

# Offset of the seed of sunlight
_SUN = 0x10000


def glazed_view_glare(
    scene: Scene,
    views: Sequence[View],
    *,
    skies: Skies,
    refinement: Refinement | None = None,
    sun_samples: int = SUN_SAMPLES,
    quantities: Collection[str] = ("dgp", "illuminance"),
    **keywords: Unpack[EffortKeywords],
) -> "xr.Dataset":
    """Return glare indices of views from one point, over time.

    Parameters
    ----------
    scene : the room, its glazing and what surrounds it, without a sky
    views : views from one point, of which line of sight and up vector define the eye
    skies : S, S_ds and S_sun, with the time steps
    refinement : how finely the sphere is sampled; default: cells 3° wide or smaller
    samples : number of paths per cell
    sun_samples : number of paths per cell and sun
    quantities : names of indices and quantities, as of `point_glare`

    The other parameters are those of `view_matrix`.

    Returns
    -------
    dataset over (view, time), NaN in dark time steps; with "dgp", also its standard
    error "dgp_error", due to paths and to the finite number of cells

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
    ...     cl.Scene(), [south], skies=skies, samples=16, device="cpu")
    >>> found.dgp.values.tolist()
    [[1.0]]
    """
    effort = effort_of(glazed_view_glare, keywords, default=Goal(SAMPLES))
    require(views, "no views; at least one expected")
    place = views[0].position
    require(
        all(np.allclose(view.position, place) for view in views),
        "views from different points; views from one point expected",
    )
    message = "skies without S_ds or S_sun; both expected for the direct sun"
    require(skies.sun is not None and skies.suns is not None, message)
    point = GlazedViewPoint(scene, tuple(views), skies, refinement or _REFINEMENT)
    cells = point.cells(effort)
    return point.glare(cells, effort, sun_samples=sun_samples, quantities=quantities)


@dataclass(frozen=True, eq=False)
class GlazedViewPoint:
    """A view point of a scene with glazing; see `glazed_view_glare`."""

    scene: Scene
    views: tuple[View, ...]
    skies: Skies
    refinement: Refinement = _REFINEMENT

    def cells(self, effort: Effort) -> SphereSamples:
        """Return the cells of the sphere, fine where DGP depends on it."""
        skies = _shining(self.skies.select(representative_steps(self.skies)))
        trial = replace(effort, samples=_TRIAL, relative_error=None)
        rounds = iter(range(1 << 10))

        def luminance(samples: SphereSamples) -> Light:
            own = replace(trial, seed=(effort.seed + 1 + next(rounds)) % 2**32)
            found = np.zeros((samples.count, len(skies.times)), np.float32)
            rows = np.flatnonzero(self._ahead(samples))
            if len(rows):
                matrices = self.matrices(samples.select(rows), skies, own, _SUN_TRIAL)
                for block in self._series(matrices, skies, len(rows)).blocks(STEPS):
                    steps = block.times.start + block.steps
                    found[rows[block.rows][:, None], steps] = block.light[0]
            return found

        return sample_sphere(
            luminance, self.views, refinement=self.refinement, seed=effort.seed
        ).centred()

    def glare(
        self,
        cells: SphereSamples,
        effort: Effort,
        *,
        sun_samples: int = SUN_SAMPLES,
        quantities: Collection[str] = ("dgp", "illuminance"),
    ) -> "xr.Dataset":
        """Return the glare indices of the views; see `glazed_view_glare`."""
        times = self.skies.times
        lit = np.flatnonzero(self.skies.whole.diffuse.max(axis=0) > 0)
        skies = self.skies.select(lit)
        ahead = cells.select(self._ahead(cells))
        matrices = self.matrices(ahead, self.skies, effort, sun_samples)
        sun = self._disc(matrices, skies, effort)
        series = self._series(matrices, skies, ahead.count, errors=True)
        model = self._model(ahead)
        light, variance, value = cell_luminance(series, model, sun)
        found = point_glare(
            ahead,
            light,
            self.views,
            sun=sun,
            times=times[lit],
            quantities=quantities,
        )
        if "dgp" in quantities:
            whole = np.zeros((cells.count, light.shape[1]), np.float32)
            whole[self._ahead(cells)] = light
            sampled = sampling_error(
                cells,
                whole,
                self.views,
                refinement=self.refinement,
                sun=sun,
                means=True,
            )
            error = limited(np.sqrt(variance + np.square(sampled)), value)
            found["dgp_error"] = ("view", "time"), error, {"units": "1"}
        return found.reindex(time=times)

    @property
    def position(self) -> Vector:
        """The view point [m]."""
        return self.views[0].position

    def _ahead(self, samples: SphereSamples) -> Bool[np.ndarray, " cell"]:
        # Cells of which some view sees a part
        looks = np.array([view.direction for view in self.views])
        cosine = samples.centred().direction @ looks.T
        width = np.sqrt(4 * np.pi) / 2.0**samples.level
        return np.asarray(cosine.max(axis=1) > -width)

    def matrices(
        self, samples: SphereSamples, skies: Skies, effort: Effort, sun_samples: int
    ) -> WindowMatrices:
        """Trace C, C_d and C_ds of cells."""
        assert skies.suns is not None
        cells = samples.cells(self.position)
        subdivision = skies.whole.partition.subdivision
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
        suns = skies.suns.directions
        C_ds = sun_view_coefficients(self.scene, cells, suns=suns, effort=own)
        return WindowMatrices(*(MatrixChain((part,)) for part in (C, C_d, C_ds)))

    def _series(
        self,
        matrices: WindowMatrices,
        skies: Skies,
        cells: int,
        *,
        errors: bool = False,
    ) -> PixelSeries:
        return PixelSeries(
            [matrices],
            METHODS["2-phase"].terms(corrected=True),
            skies,
            None,
            equation_bands([matrices], skies).weights[None],
            cells,
            errors=errors,
        )

    def _model(self, samples: SphereSamples) -> DgpModel:
        how = self.refinement
        return DgpModel(samples, self.views, how.threshold, how.coefficients)

    def _disc(self, matrices: WindowMatrices, skies: Skies, effort: Effort) -> SunDisc:
        # The sun's disc at each time step
        assert skies.suns is not None
        suns, steps = skies.suns, len(skies.times)
        share, passed = sun_disc(
            self.scene, self.position, suns.directions, device=effort.device
        )
        direction = np.tile([0.0, 0.0, 1.0], (steps, 1))
        level, angle = np.zeros(steps), np.zeros(steps)
        normal = suns.direct_normal.tocoo()
        sun, step = normal.coords
        efficacy = equation_bands([matrices], skies).weights.sum()
        direction[step] = suns.directions[sun]
        level[step] = normal.data * passed[sun] * efficacy / SUN_SOLID_ANGLE
        angle[step] = SUN_SOLID_ANGLE * share[sun]
        return SunDisc(direction, level, angle)


def _shining(skies: Skies) -> Skies:
    # The skies with the suns that shine in some time step
    assert skies.suns is not None
    normal = skies.suns.direct_normal.tocsr()
    some = np.flatnonzero(np.diff(normal.indptr))
    suns = replace(
        skies.suns,
        directions=skies.suns.directions[some],
        direct_normal=csc_array(normal[some]),
    )
    return replace(skies, suns=suns)
