"""The five-phase tutorial by both programs, ready to be compared.

What Radiance's own runs differ by tells its noise, and two seeds tell ours.
"""

from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from tutorial import SUN_SR, Tutorial

import clerestory as cl
from clerestory.bands import RGB
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.image.camera import Camera
from clerestory.phases.direct_light import blackened
from clerestory.phases.matrix_equation import (
    MatrixChain,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.matrix_equation import (
    Skies as OurSkies,
)
from clerestory.phases.methods import FIVE_PHASE, five_phase
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.picture_series import pictures_over_time
from clerestory.phases.sun_coefficients import (
    picture_sun_coefficients,
    sun_coefficients,
)
from clerestory.sky.sun_matrix import patch_suns

VIEWS = ("south", "eastBlinds")
BOUNCES = 4
WEIGHTS = RGB.weights


def write_tree(source: Path, path: Path) -> None:
    """Generate the tree that the tutorial names and does not hold, from its blind."""
    tree = cl.generate_bsdf(
        cl.read_rad(source / "blinds" / "blinds.rad"),
        basis="tree4", halvings=5, sides="front", samples=1000, seed=1, geometry=False,
    )  # fmt: skip
    write_bsdf(path, tree)


@dataclass(frozen=True, eq=False)
class Many:
    """Independent estimates of one array.

    Attributes
    ----------
    values : (run, …)
    """

    values: np.ndarray

    @classmethod
    def of(cls, make, runs: int) -> "Many":
        """Make it for every run's number."""
        return cls(np.stack([np.asarray(make(run), float) for run in range(runs)]))

    @property
    def mean(self) -> np.ndarray:
        """The best estimate."""
        return self.values.mean(axis=0)

    @property
    def variance(self) -> np.ndarray:
        """Variance of the mean."""
        return self.values.var(axis=0, ddof=1) / len(self.values)


def distance(ours: Many, theirs: Many) -> float:
    """Root mean square difference over that expected from the noise of both."""
    expected = (ours.variance + theirs.variance).mean()
    return float(np.sqrt(np.mean((ours.mean - theirs.mean) ** 2) / expected))


class OurTutorial:
    """Our side: the same matrices, with the same sky, suns and BSDFs."""

    def __init__(self, room, tree, suns):
        self.scene = cl.read_rad(room / "materials.rad", room / "room.rad")
        self.window = cl.read_window(room / "objects" / "GlazingVmtx.rad")
        self.sensors = cl.read_sensors(room / "points.txt")
        self.weather = cl.read_weather(room / "assets" / "NYC.wea")
        self.tree, self.suns = tree, suns
        self.room = room
        bsdf = cl.read_bsdf(room / "blinds" / "blinds.xml")
        self.transmission = bsdf.transmission_matrix(window=self.window.name)

    def view(self, seed: int, *, direct: bool, samples: int):
        scene = blackened(self.scene) if direct else self.scene
        return cl.view_matrix(
            scene, self.window, sensors=self.sensors, samples=samples,
            bounces=1 if direct else BOUNCES, seed=100 + seed,
        )  # fmt: skip

    def daylight(self, seed: int, *, direct: bool, samples: int):
        scene = blackened(self.scene) if direct else self.scene
        return cl.daylight_matrix(
            scene, self.window, subdivision=1, samples=samples,
            bounces=0 if direct else BOUNCES, seed=200 + seed,
        )  # fmt: skip

    def sun(self, seed: int, *, samples: int, peak: bool = True):
        return sun_coefficients(
            self.scene, [self.window], self.window.name, self.tree,
            sensors=self.sensors, suns=self.suns, samples=samples, seed=300 + seed,
            peak=peak,
        )  # fmt: skip

    def pixels(self, view: str, shape, seed: int, *, direct: bool):
        found = picture_view_matrices(
            self.scene, [self.window], self.camera(view, shape), direct=direct,
            samples=1024, bounces=BOUNCES, seed=400 + seed,
        )  # fmt: skip
        return found[self.window.name]

    def sun_pixels(self, view: str, shape, seed: int):
        return picture_sun_coefficients(
            self.scene, [self.window], self.window.name, self.tree,
            self.camera(view, shape), suns=self.suns, samples=64, seed=500 + seed,
            peak=True,
        )  # fmt: skip

    def skies(self):
        """S, S_ds, and S_sun of the suns that occur."""
        whole, spread = (
            cl.sky_matrix(
                self.weather, subdivision=1, include=part, sun_formula="radiance"
            )
            for part in ("all", "sun")
        )
        every = patch_suns(self.weather, sun_formula="radiance")
        lit = np.flatnonzero(every.direct_normal.max(axis=1).toarray().ravel() > 0)
        return (
            whole,
            spread,
            replace(
                every,
                directions=every.directions[lit],
                direct_normal=every.direct_normal[lit],
            ),
        )

    def camera(self, view: str, shape) -> Camera:
        return Camera(cl.read_view(self.room / "views" / f"{view}.vf"), *shape)


def light(matrix: np.ndarray) -> np.ndarray:
    """Illuminance or luminance per unit of each column, channels weighted."""
    three = np.broadcast_to(matrix, (3, *matrix.shape[1:]))
    return np.tensordot(WEIGHTS, three, axes=1)


@dataclass(frozen=True, eq=False)
class Skies:
    """S, S_ds and S_sun of gendaymtx, by luminance; suns are those that occur."""

    whole: np.ndarray
    sun: np.ndarray
    suns: np.ndarray

    @classmethod
    def of(cls, theirs: Tutorial) -> "Skies":
        irradiance = theirs.sky("-5 0.533 -d -m 6")[:, 1:][:, theirs.lit()] * SUN_SR
        return cls(
            light(theirs.sky("-m 1")), light(theirs.sky("-m 1 -d")), light(irradiance)
        )

    def five(self, parts: dict, transmission: np.ndarray) -> np.ndarray:
        """V T D S − V_d T D_d S_ds + C S_sun (row, hour), of grey matrices."""
        whole = parts["V"] @ transmission @ parts["D"] @ self.whole
        direct = parts["V_d"] @ transmission @ parts["D_d"] @ self.sun
        return whole - direct + parts["C"] @ self.suns


# Matrices of the points
SYMBOLS = ("V", "V_d", "D", "D_d", "C")


class Pair:
    """Both programs at work on the tutorial, with one tree in the window.

    Its straight light is kept apart (aBSDF, `peak`): what Radiance spreads over
    directions it also blurs, by the size of a tree's cells.
    """

    def __init__(self, theirs: Tutorial, tree: Path):
        self.theirs = theirs
        self.ours = OurTutorial(theirs.folder, cl.read_bsdf(tree), theirs.suns())
        self.skies = Skies.of(theirs)
        self.octree = theirs.with_bsdf(tree, peak=True)

    @cache  # noqa: B019  (one pair in a session)
    def theirs_of(self, symbol: str) -> Many:
        """A matrix of the points by Radiance, once for every run."""
        made, direct = self.theirs, symbol.endswith("_d")
        how = {
            "V": lambda run: made.view(run, direct=direct)[1],
            "D": lambda run: made.daylight(run, direct=direct)[1],
            "C": lambda run: made.sun(run, self.octree)[1],
        }
        return Many.of(how[symbol[0]], made.effort.runs)

    @cache  # noqa: B019
    def ours_of(self, symbol: str) -> list:
        """A matrix of the points by Clerestory, twice."""
        made, direct = self.ours, symbol.endswith("_d")
        how = {
            "V": lambda seed: made.view(seed, direct=direct, samples=1 << 15),
            "D": lambda seed: made.daylight(seed, direct=direct, samples=1 << 13),
            "C": lambda seed: made.sun(seed, samples=32768),
        }
        return [how[symbol[0]](seed) for seed in (0, 1)]

    def matrices(self, symbol: str) -> tuple[Many, Many]:
        """One matrix by both, ours first."""
        ours = Many(np.stack([m.values[0] for m in self.ours_of(symbol)]))
        return ours, self.theirs_of(symbol)

    def illuminance(self) -> tuple[np.ndarray, np.ndarray, Many]:
        """Ours, its standard error, and theirs (sensor, hour) [lux]."""
        first = {symbol: self.ours_of(symbol)[0] for symbol in SYMBOLS}
        T = self.ours.transmission
        parts = WindowMatrices(
            window_chain(first["V"], T, first["D"]),
            window_chain(first["V_d"], T, first["D_d"]),
            MatrixChain((first["C"],)),
        )
        found = five_phase([parts], *self.ours.skies())

        def one(run: int) -> np.ndarray:
            parts = {each: self.theirs_of(each).values[run] for each in SYMBOLS}
            return self.skies.five(parts, T.values[0])

        theirs = Many.of(one, self.theirs.effort.runs)
        return found["illuminance"].values, found["standard_error"].values, theirs

    def pictures(self, view: str) -> tuple[Many, Many, np.ndarray]:
        """Luminance (pixel, hour) by both, and which of it shows no sun.

        Radiance's rays of a pixel tell its noise. Of nine rays one or none meets the
        sun's disc, a thousand times as bright as all else.
        """
        shape = self.theirs.shape(view)
        ours = Many.of(lambda run: self._ours(view, shape, run), 2)
        rays = self._theirs(view).reshape(
            shape[0] * shape[1], self.theirs.effort.rays, -1
        )
        theirs = Many(np.moveaxis(rays, 1, 0))
        looks = self.ours.camera(view, shape).view.rays(*shape).direction
        near = looks.reshape(-1, 3) @ self.ours.suns.T > np.cos(np.radians(3))
        return ours, theirs, near @ (self.skies.suns > 0) == 0

    def facade(self, view: str) -> tuple[float, float, float]:
        """Direct sun in pixels that show nothing but window, over suns beside them.

        Ours, Radiance's, and what the file's table says along Radiance's rays.
        """
        made, suns = self.ours, self.ours.suns
        shape = self.theirs.shape(view)
        _, found = (each[1] for each in self.theirs.sun_pixels(view, self.octree))
        looks = self.theirs.ray_directions(view)
        frame = made.window.frame
        axes = np.stack([frame.right, frame.up, frame.normal], axis=-1)
        slant = np.maximum(-suns @ frame.normal, 0)
        table = np.stack(
            [made.tree.evaluate(sun @ axes, -looks @ axes) for sun in suns], axis=1
        )
        table = np.where(found > 0, table * slant, 0)
        ours = made.sun_pixels(view, shape, 0).values[0]
        each = (len(ours), -1, len(suns))
        window = (found.reshape(each).sum(axis=2) > 0).all(axis=1)
        near = looks.reshape(len(ours), -1, 3)[:, 0] @ suns.T > np.cos(np.radians(5))
        shown = window[:, None] & ~near
        theirs, table = (a.reshape(each).mean(axis=1) for a in (found, table))
        return tuple(float(a[shown].sum()) for a in (ours, theirs, table))

    def _theirs(self, view: str) -> np.ndarray:
        # Luminance of each ray in each hour
        room, facade = self.theirs.sun_pixels(view, self.octree)
        parts = {
            "V": self.theirs.pixels(view, direct=False)[1],
            "V_d": self.theirs.pixels(view, direct=True)[1],
            "D": self.theirs_of("D").mean,
            "D_d": self.theirs_of("D_d").mean,
            "C": (room + facade)[1],
        }
        return self.skies.five(parts, self.ours.transmission.values[0])

    def _ours(self, view: str, shape: tuple[int, int], run: int) -> np.ndarray:
        made, T = self.ours, self.ours.transmission
        D, D_d = (self.ours_of(symbol)[0] for symbol in ("D", "D_d"))
        window = WindowMatrices(
            window_chain(made.pixels(view, shape, run, direct=False), T, D),
            window_chain(made.pixels(view, shape, run, direct=True), T, D_d),
            MatrixChain((made.sun_pixels(view, shape, run),)),
        )
        pictures = pictures_over_time(
            [window], FIVE_PHASE, made.camera(view, shape), OurSkies(*made.skies())
        )
        return np.stack([p.luminance().ravel() for p in pictures], axis=1)
