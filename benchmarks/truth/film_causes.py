"""Why methods deviate behind a film: direct sun and the rest, on finer patches too.

Direct sun is light that reaches a sensor from the window without a reflection in the
room. Five phases replace it; the rest, V T D S - V_d T D_d S_ds, is that of three
phases. The rest is made again with finer sky patches, with finer patches of the window
in place of Klems', and with the rays of the sun that the truth traces through the film
in place of T D_d S_ds.
"""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.bands import RGB
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition
from clerestory.phases.direct_light import blackened
from clerestory.phases.traced_matrices import daylight_matrices, view_matrices
from clerestory.scene.window import Window
from truth import methods, reference
from truth.facades import Kind
from truth.kept import Arrays
from truth.setting import HEIGHT, WIDTH, demo

# Paths of a row of V, relative to those of both methods: narrow beams are noisier
_MORE = 16


@dataclass(frozen=True)
class Variant:
    """How the rest is made.

    Attributes
    ----------
    text : for the table
    halved : how often the widths of Klems' patches are halved
    tree : whether T is the mean of the tensor tree, not of rays traced for Klems' basis
    rays : whether the sun passes the film by rays, not by T D_d S_ds
    subdivision : MF of the sky's patches
    """

    text: str
    halved: int = 0
    tree: bool = True
    rays: bool = False
    subdivision: int = 4


VARIANTS = (
    Variant("145 Klems patches, sky MF 4, as in both methods", tree=False),
    Variant("T from the tensor tree", tree=True),
    Variant("sky MF 6", tree=False, subdivision=6),
    Variant("580 patches of half the width", halved=1),
    Variant("2320 patches of a quarter of the width", halved=2),
    Variant("145 Klems patches, sun through the film by rays", tree=False, rays=True),
    Variant("2320 patches, sun through the film by rays", halved=2, rays=True),
)


def sunlight(
    kind: Kind, hours: cl.Weather, *, paths: methods.MethodPaths, folder: Path | None
) -> Arrays:
    """Return direct sun of the truth, and the flux of the sun through the window.

    `lux_direct` (sensor, step) and `lux_direct_error` [lux]; `flux_patches` and
    `flux_rays` (step) [W/m²] by both methods and by the rays of the truth.
    """
    film, sensors = reference.film(kind), demo()[2]
    found = [film.direct_sun(hours, time, sensors) for time in hours.times.tolist()]
    lux, error = np.moveaxis(np.array(found), 0, -1)
    window = _window(kind, 0)
    rays = window.partition.projected_solid_angles() @ _by_rays(kind, hours, window)[0]
    patches = methods.sun_flux(kind, hours, paths, folder)
    return {
        "lux_direct": lux,
        "lux_direct_error": error,
        "flux_patches": patches,
        "flux_rays": rays,
    }


def black(kind: Kind, hours: cl.Weather, *, samples: int, seed: int) -> Arrays:
    """Return `lux` and `lux_error` if the film reflects no light of the room."""
    film = reference.film(kind, mirrors=False)
    [time] = hours.times.tolist()
    lux, error = film.illuminance(hours, time, demo()[2], samples=samples, seed=seed)
    return {"lux": lux[:, None], "lux_error": error[:, None]}


def rests(
    kind: Kind, hours: cl.Weather, *, paths: methods.MethodPaths, folder: Path | None
) -> Arrays:
    """Return `lux_rest` of the methods (variant, sensor, step) [lux]."""
    coarse, fine = methods.bsdfs(kind.parts[0], folder)
    found = []
    for variant in VARIANTS:
        window = _window(kind, variant.halved)
        bsdf = fine if variant.tree else coarse
        T = bsdf.transmission_matrix(partition=window.partition).values
        effort = replace(paths, subdivision=variant.subdivision)
        sky, sun = (methods.sky_of(hours, effort, p).values for p in ("sky", "sun"))
        reflected, V = _views(window, effort.row)
        D, D_d = _daylight(window, effort)
        # Sun that is reflected outdoors before the film stays with D
        passed = _by_rays(kind, hours, window) if variant.rays else T @ D_d @ sun
        entering = T @ (D @ sky + (D - D_d) @ sun)
        radiance = V @ entering + reflected @ passed
        found.append(np.tensordot(RGB.weights, radiance, 1))
    return {"lux_rest": np.array(found)}


def halved(basis: RingPartition, times: int) -> RingPartition:
    """Return a basis of rings whose patches are halved so often in both angles."""
    parts = 1 << times
    steps = np.arange(parts) / parts
    limits = basis.theta[:-1, None] + np.diff(basis.theta)[:, None] * steps
    theta = np.append(limits.ravel(), basis.theta[-1])
    count = np.repeat(parts * basis.count, parts)
    return RingPartition(f"{basis.name}, {parts}", count, theta, basis.azimuth)


@cache
def _window(kind: Kind, times: int) -> Window:
    return replace(kind.parts[0].window(), partition=halved(klems("full"), times))


@cache
def _views(window: Window, paths: int) -> tuple[np.ndarray, np.ndarray]:
    # V - V_d and V, from the same paths: a difference without the noise of V_d
    room, _, sensors, _ = demo()
    effort = {"sensors": sensors, "samples": _MORE * paths, "seed": 1}
    V = view_matrices(room, [window], **effort)[window.name].values
    V_d = view_matrices(blackened(room), [window], bounces=1, **effort)
    return V - V_d[window.name].values, V


@cache
def _daylight(
    window: Window, paths: methods.MethodPaths
) -> tuple[np.ndarray, np.ndarray]:
    room = demo()[0]
    effort = {"subdivision": paths.subdivision, "samples": paths.row, "seed": 2}
    D = daylight_matrices(room, [window], **effort)
    D_d = daylight_matrices(blackened(room), [window], bounces=0, **effort)
    return D[window.name].values, D_d[window.name].values


def _by_rays(kind: Kind, hours: cl.Weather, window: Window) -> np.ndarray:
    # Mean radiance of the window's patches by the sun (1, patch, step) [W/(m² sr)]
    basis, frame = window.partition, window.frame
    axes = np.stack([frame.right, frame.up, frame.normal], axis=-1)
    film, found = reference.film(kind), []
    for time in hours.times.tolist():
        sun = film.when(hours, time).beams
        direction = np.array(sun.direction).T.astype(float) @ axes
        flux = np.array(sun.irradiance) * direction[:, 2] / int(sun.count[0])
        low_x, high_x, low_z, high_z = (float(edge[0]) for edge in sun.lit)
        lit = max(high_x - low_x, 0) * max(high_z - low_z, 0) / (WIDTH * HEIGHT)
        patch = np.bincount(basis.find(direction), flux * lit, len(basis))
        found.append(patch / basis.projected_solid_angles())
    return np.array(found).T[None]
