"""Tracing of view points for annual glare, without pictures.

The sphere around a point is divided into cells, fine where DGP depends on it. V and
the paths to the windows are traced for the cells as for pixels. The cells are chosen by
the luminance at a few hundred time steps with all kinds of sky, positions of the sun
and shade states.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import TYPE_CHECKING, Unpack

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Vector
from clerestory.checks import distinct, has_shape, require
from clerestory.engine.effort import Effort, EffortKeywords, effort_of
from clerestory.engine.work_units import Goal
from clerestory.glare.point_glare import views_around
from clerestory.glare.representative_steps import representative_steps
from clerestory.glare.sphere_refinement import (
    Refinement,
    sample_sphere,
)
from clerestory.glare.sphere_samples import SphereSamples, regular_samples
from clerestory.glare.view_points import ViewPoint
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import (
    Skies,
    Term,
    WindowMatrices,
)
from clerestory.phases.methods import FIVE_PHASE
from clerestory.phases.picture_matrices import (
    picture_view_matrices,
    reflected_view_matrices,
)
from clerestory.phases.shaded_windows import ShadedWindow, receiving_matrices
from clerestory.phases.window_paths import picture_window_paths
from clerestory.scene.model import Scene
from clerestory.scene.view import View
from clerestory.threads import linear_algebra_in_one_thread

if TYPE_CHECKING:
    pass

# Default number of paths per cell, and of each kind while the cells are chosen
_SAMPLES, _SUN_SAMPLES, _TRIAL = 256, 128, 64

# Seed offset of the paths to windows
_PATHS = 0x10000


def trace_view_point(
    scene: Scene,
    windows: Sequence[ShadedWindow],
    position: Vector,
    *,
    skies: Skies,
    terms: Sequence[Term] = FIVE_PHASE,
    views: Sequence[View] | None = None,
    refinement: Refinement | None = None,
    sun_samples: int = _SUN_SAMPLES,
    **keywords: Unpack[EffortKeywords],
) -> ViewPoint:
    """Trace the matrices of a view point for annual glare in several directions.

    Parameters
    ----------
    scene : room surfaces, without the windows
    windows : window groups and their shade states
    position : the view point [m]
    skies : S, and for the direct correction S_ds and S_sun
    terms : terms of the method, such as `THREE_PHASE`; F D in place of D gives the
        four- and six-phase methods
    views : views from the point; default: eight horizontal directions, from north
    refinement : how finely the sphere is sampled
    samples : number of paths per cell for V
    sun_samples : number of paths per cell to the windows, for the direct correction

    The other parameters are those of `view_matrix`.

    Raises
    ------
    InputError : the position is not a point, a view is from another position, a window
        has no states, or a number is out of range

    Examples
    --------
    >>> import clerestory as cl
    >>> from clerestory.bsdf.analytic import lambertian
    >>> from clerestory.directions import Frame
    >>> from clerestory.phases.methods import THREE_PHASE
    >>> from clerestory.phases.shaded_windows import ShadedWindow, ShadeState
    >>> from clerestory.scene.model import Polygon
    >>> room, edges = cl.Scene(), [[0, 0, 0], [0, 0, 2], [3, 0, 2], [3, 0, 0]]
    >>> front = Frame.from_normal_up(np.eye(3)[1], np.eye(3)[2])
    >>> opening = (Polygon(np.array(edges, dtype=float), "", "opening"),)
    >>> south = cl.Window("south", opening, front, cl.klems("quarter"))
    >>> D = cl.daylight_matrix(room, south, subdivision=1, samples=16)
    >>> T = [lambertian(t, cl.klems("quarter")).transmission_matrix() for t in (0.6, 0)]
    >>> states = tuple(ShadeState(whole=(matrix, D)) for matrix in T)
    >>> weather = cl.Weather(
    ...     place="Oakland", latitude_deg=37.7, longitude_deg=-122.2, elevation=0.0,
    ...     utc_offset_hours=-8.0, times=np.array(["2023-03-21T12:30"], "M8[m]"),
    ...     step_minutes=60.0, direct_normal=np.array([600.0]),
    ...     diffuse_horizontal=np.array([150.0]), source="an example"
    ... )
    >>> point = cl.trace_view_point(
    ...     room, [ShadedWindow(south, states)], np.array([1.5, 1, 1]),
    ...     skies=Skies(cl.sky_matrix(weather, subdivision=1)), terms=THREE_PHASE,
    ...     samples=16, device="cpu"
    ... )
    >>> for state in (0, 1):
    ...     print(point.glare([np.array([state])]).dgp.max().round(1).item())
    1.0
    0.2
    """
    effort = effort_of(trace_view_point, keywords, default=Goal(_SAMPLES))
    point = np.asarray(position, dtype=float)
    has_shape(point, (3,), "view point")
    require(np.isfinite(point).all(), f"view point is {point}; finite numbers expected")
    require(windows, "no window given; at least one expected")
    distinct((each.window.name for each in windows), "windows")
    looks = tuple(views_around(8, position=point) if views is None else views)
    require(looks, "no views; at least one expected")
    tracer = ViewPointTracer(scene, tuple(windows), skies, tuple(terms))
    return tracer.point(
        point,
        looks,
        refinement=refinement or Refinement(),
        effort=effort,
        sun_samples=sun_samples,
    )


@dataclass(frozen=True, eq=False)
class ViewPointTracer:
    """A room with its windows and skies, in which view points are traced.

    What does not depend on the point is computed once: see `trace_view_point`.
    """

    scene: Scene
    windows: tuple[ShadedWindow, ...]
    skies: Skies
    terms: tuple[Term, ...]
    _known: list[tuple[WindowMatrices, ...]] = field(default_factory=list)

    def point(
        self,
        position: Vector,
        views: Sequence[View],
        *,
        refinement: Refinement,
        effort: Effort,
        sun_samples: int = _SUN_SAMPLES,
    ) -> ViewPoint:
        """Choose the cells of a view point, and trace its matrices."""
        blank = self.blank(position, views, refinement)
        samples = self.cells(blank, effort)
        V = self.view_matrices(blank, samples, effort)
        return self.traced(blank, samples, V, effort, sun_samples=sun_samples)

    def blank(
        self, position: Vector, views: Sequence[View], refinement: Refinement
    ) -> ViewPoint:
        """Return a view point without matrices."""
        none = regular_samples(0)
        rest = self.terms, self.skies, refinement
        return ViewPoint(position, tuple(views), none, (), *rest)

    def cells(self, point: ViewPoint, effort: Effort) -> SphereSamples:
        """Return the cells of the sphere, fine where DGP depends on it."""
        steps = self._steps
        states = [np.arange(len(steps)) % len(each.states) for each in self.windows]
        trial = replace(effort, samples=_TRIAL, relative_error=None)
        rounds = iter(range(1 << 10))

        def luminance(samples: SphereSamples) -> Float[np.ndarray, "cell step"]:
            own = replace(trial, seed=(effort.seed + 1 + next(rounds)) % 2**32)
            V = self.view_matrices(point, samples, own)
            found = self.traced(point, samples, V, own, sun_samples=_TRIAL)
            return found.luminance(states, steps)

        with linear_algebra_in_one_thread():
            samples = sample_sphere(
                luminance,
                point.views,
                refinement=point.refinement,
                details=_middles(self.windows, point.position),
                seed=effort.seed,
            )
        return samples.centred()

    @cached_property
    def _steps(self) -> Int[np.ndarray, " step"]:
        return representative_steps(self.skies)

    @property
    def sunlit(self) -> bool:
        """Whether direct sunlight has matrices of its own."""
        return any(term.part == "sun" for term in self.terms)

    def view_matrices(
        self, point: ViewPoint, samples: SphereSamples, effort: Effort
    ) -> dict[str, TransferMatrix]:
        """Return V by window name; of reflected light alone if the sun is direct."""
        cells = samples.cells(point.position)
        inner = [each.window for each in self.windows]
        trace = reflected_view_matrices if self.sunlit else picture_view_matrices
        return trace(self.scene, inner, cells, effort=effort)

    def traced(
        self,
        point: ViewPoint,
        samples: SphereSamples,
        views: Mapping[str, TransferMatrix],
        effort: Effort,
        *,
        sun_samples: int,
    ) -> ViewPoint:
        """Return the view point with given V; trace the paths to the windows."""
        paths = None
        if self.sunlit:
            own = replace(
                effort,
                samples=sun_samples,
                relative_error=None,
                bounces=None,
                seed=(effort.seed + _PATHS) % 2**32,
            )
            cells = samples.cells(point.position)
            inner = [each.window for each in self.windows]
            paths = picture_window_paths(self.scene, inner, cells, effort=own)
        suns = None if self.skies.suns is None else self.skies.suns.directions
        like = self._known[0] if self._known else None
        found = receiving_matrices(self.windows, views, paths, suns, like=like)
        self._known[:] = [found]
        return replace(point, samples=samples, windows=found)


def _middles(
    windows: Sequence[ShadedWindow], point: Vector
) -> Float[np.ndarray, "window 3"]:
    # Directions to the middle of each polygon of the windows
    middles = [
        polygon.vertices.mean(axis=0)
        for shaded in windows
        for polygon in shaded.window.polygons
    ]
    away = np.array(middles) - point
    return np.asarray(away / np.linalg.norm(away, axis=1, keepdims=True))
