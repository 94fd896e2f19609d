"""Layers whose light is traced from their geometry, for the virtual goniophotometer.

Light comes from a small disc about an incident direction and is counted in the fine
cells of the hemisphere that it leaves through. What the instrument then sees, and the
truth that interpolation is judged by, are both made of these counts.
"""

import functools
from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

from clerestory.bsdfgen.shading_system import SampleArea, System
from clerestory.engine.primary_rays import lanes
from clerestory.engine.sample_area import follow, lower_slab, start
from clerestory.engine.sampler import points
from clerestory.engine.sinks import FIXED_POINT, MatrixSink
from clerestory.engine.square import square_from_disc
from clerestory.gonio.angles import angle_between, undeviated
from clerestory.gonio.raster import Raster
from clerestory.gonio.scattering_measurement import Measurement, Scan
from clerestory.hemisphere.shirley_chiu import disc_from_square
from clerestory.scene.model import Polygon, Scene, Trans

# Fine cells are 2^9 along an axis: 0.35° wide at the normal.
HALVINGS = 9

# Light this near belongs to one beam [rad]: 6°; a beam has this share of what comes in.
BEAM, LEAST_BEAM = np.radians(6.0), 0.05


def rough_pane(*, roughness=0.12):
    """Pane that lets most light on within a lobe (Radiance's `trans`)."""
    sheet = Trans("pane", np.full(3, 0.9), 0.0, roughness, 0.9, 0.85)
    corners = np.array([[-0.1, -0.1, 0], [1.1, -0.1, 0], [1.1, 1.1, 0], [-0.1, 1.1, 0]])
    scene = Scene({"pane": sheet}, (Polygon(corners, "pane", "pane"),))
    return System(scene, SampleArea(np.array([[0.0, 0, 0], [1, 1, 0]]), periodic=True))


@dataclass(frozen=True, eq=False)
class Light:
    """Transmitted light from one incident direction.

    Attributes
    ----------
    direction : unit vectors of the fine cells that light leaves through
    flux : share of the incident light in each
    """

    direction: np.ndarray
    flux: np.ndarray

    @property
    def total(self):
        return float(self.flux.sum())

    def seen(self, leaving, aperture):
        """BSDF that a disc-shaped aperture of a radius [rad] sees [1/sr]."""
        near = cKDTree(self.direction).query_ball_point(
            leaving, 2 * np.sin(aperture / 2)
        )
        light = np.array([self.flux[k].sum() for k in near])
        solid_angle = 2 * np.pi * (1 - np.cos(aperture))
        return light / (solid_angle * np.maximum(leaving[:, 2], 1e-3))


@dataclass(eq=False)
class TracedLayer:
    """A layer whose geometry is traced.

    Attributes
    ----------
    system : its geometry
    paths : from each incident direction
    source : radius of the disc that light comes from [rad]
    """

    system: System
    paths: int = 1 << 18
    source: float = np.radians(0.25)
    seed: int = 1

    def __post_init__(self):
        area = self.system.area
        self._slab = lower_slab(self.system.scene, area.slab(), periodic=True)

    def light(self, incidents):
        """Transmitted light from each direction."""
        return [self._traced(d, k) for k, d in enumerate(incidents)]

    def _traced(self, incident, number):
        wide = 1 << HALVINGS
        target = MatrixSink(dr.zeros(mi.UInt64), wide * wide, 1)
        target.sums = dr.zeros(mi.UInt64, wide * wide + 1)
        table = _Disc(mi.Vector3f(*undeviated(incident).tolist()), self.source)
        dr.make_opaque(table.centre)
        for first in range(0, self.paths, 1 << 16):
            sequence = points(first, min(1 << 16, self.paths - first))
            rows = np.array([number])
            paths = lanes(sequence, rows=rows, batches=1, seed=self.seed, stream=0)
            front = dr.opaque(mi.Bool, False)
            ray = start(self._slab, paths.numbers, table, mi.UInt32(0), front)
            follow(self._slab, _Cells(target), paths.numbers, ray, 1 << 20)
            dr.eval(target.sums)
        flux = target.sums.numpy()[:-1] / (FIXED_POINT * self.paths)
        cell = np.flatnonzero(flux)
        a, b = (cell // wide + 0.5) / wide, (cell % wide + 0.5) / wide
        x, y = disc_from_square(a, b)
        z = np.sqrt(np.maximum(1 - x * x - y * y, 0))
        return Light(np.stack([x, y, z], axis=-1), flux[cell])


@dataclass
class _Disc:
    # Directions of travel evenly within a disc about one
    centre: mi.Vector3f
    radius: float

    def sample(self, _cell, u, v):
        disc = mi.warp.square_to_uniform_disk_concentric(mi.Point2f(u, v))
        local = mi.Vector3f(disc.x, disc.y, 0) * self.radius
        found = dr.normalize(mi.Frame3f(self.centre).to_world(local) + self.centre)
        found.z = dr.abs(found.z)
        return found


@dataclass
class _Cells:
    target: MatrixSink

    def receive(self, direction, weight, active):
        place = square_from_disc(direction.x, direction.y) * (1 << HALVINGS)
        a, b = (
            mi.UInt32(dr.clip(mi.Int32(c), 0, (1 << HALVINGS) - 1))
            for c in (place.x, place.y)
        )
        through = active & (direction.z > 0)
        self.target.add(None, (a << HALVINGS) + b, weight, through)


def beam(light, near):
    """Middle of the light within 6° of itself, sought uphill of a direction."""
    middle = near
    for _ in range(50):
        within = angle_between(light.direction, middle) < BEAM
        total = light.flux[within] @ light.direction[within]
        if not np.any(total):
            return near
        found = total / np.linalg.norm(total)
        if angle_between(found, middle) < 1e-5:
            break
        middle = found
    return middle


def beams(light):
    """Beams of the light, brightest first, and the share of each."""
    left = light.flux.copy()
    wide = cKDTree(light.direction)
    found, shares = [], []
    while len(left) and left.max() > 0:
        # Start at the brightest 2° and climb
        chosen = np.argsort(left)[-200:]
        near = wide.query_ball_point(light.direction[chosen], np.radians(2.0))
        start_at = chosen[np.argmax([left[k].sum() for k in near])]
        middle = beam(light, light.direction[start_at])
        within = angle_between(light.direction, middle) < BEAM
        share = float(light.flux[within].sum())
        taken = float(left[within].sum())
        if taken < LEAST_BEAM:
            break
        if taken > 0.7 * share:
            found.append(middle)
            shares.append(share)
        left[within] = 0
        left[wide.query_ball_point(light.direction[start_at], BEAM)] = 0
    return np.array(found).reshape(-1, 3), np.array(shares)


# The instrument: radius of its aperture [rad], noise of values and of its dark [1/sr],
# points over the hemisphere and about what is bright.
APERTURE, NOISE, DARK = np.radians(0.7), 0.02, 2e-4
EVERYWHERE, NEAR_PEAKS = 4000, 6000


def measure(incidents, lights, *, name="", seed=1):
    """Scans of a layer by a virtual goniophotometer."""
    rng = np.random.default_rng(seed)
    scans = tuple(_scan(d, x, rng) for d, x in zip(incidents, lights, strict=True))
    return Measurement(scans, "transmission_front", name=name)


def _scan(incident, light, rng):
    k = np.arange(EVERYWHERE) + 0.5
    z, turn = 1 - k / EVERYWHERE, np.pi * (1 + 5**0.5) * k
    flat = np.sqrt(1 - z * z)
    leaving = np.stack([flat * np.cos(turn), flat * np.sin(turn), z], axis=-1)

    # Scan within 3° of what is bright once more, finer
    spots = _spots(light)
    if len(spots):
        centre = np.repeat(spots, NEAR_PEAKS // len(spots), axis=0)
        aside = rng.normal(size=centre.shape)
        aside -= np.sum(aside * centre, axis=1, keepdims=True) * centre
        aside /= np.linalg.norm(aside, axis=1, keepdims=True)
        away = np.radians(3.0) * np.sqrt(rng.random((len(centre), 1)))
        near = centre + aside * away
        near /= np.linalg.norm(near, axis=1, keepdims=True)
        leaving = np.concatenate([leaving, near])

    # No detector near the horizon, nor behind the arm on the right
    leaving = leaving[leaving[:, 2] > np.cos(np.radians(87))]
    low = leaving[:, 2] < np.cos(np.radians(30))
    beside = np.abs(np.arctan2(leaving[:, 1], leaving[:, 0])) < np.radians(4)
    leaving = leaving[~(low & beside)]
    value = light.seen(leaving, APERTURE)
    value = value * (1 + NOISE * rng.normal(size=len(value)))
    return Scan(incident, leaving, value + DARK * rng.normal(size=len(value)))


def _spots(light):
    # Places with at least 0.3 % of the light within 1.5°, brightest first
    left, tree, found = light.flux.copy(), cKDTree(light.direction), []
    while len(left) and len(found) < 100:
        chosen = np.argsort(left)[-50:]
        near = tree.query_ball_point(light.direction[chosen], np.radians(1.5))
        shares = [left[k].sum() for k in near]
        best = int(np.argmax(shares))
        if shares[best] < 0.003 * light.total:
            break
        middle = left[near[best]] @ light.direction[near[best]]
        middle /= np.linalg.norm(middle)
        found.append(middle)
        left[near[best]] = 0
        left[tree.query_ball_point(middle, np.radians(2.0))] = 0
    return np.array(found)


def drawn(lobes):
    """Light of lobes in the cells of a grid of 2^7."""
    cells = Raster.of(7).cells(lobes)
    return Light(_cells(), cells * (np.pi / len(cells)))


def compare(found, truth):
    """Error of the flux, angle between the brightest beams [°], ghosts."""
    turns = turned_by(found, truth)
    ghost = 0.0
    if len(turns):
        real, seen = (_within_3_degrees(light) for light in (truth, found))
        lit = cKDTree(_cells()[real > 0.02 * real.max()])
        away = lit.query(_cells())[0] > np.radians(4.0)
        ghost = float((seen - real)[away].max(initial=0) / real.max())
    turn = float(turns[0]) if len(turns) else 0.0
    return found.total - truth.total, turn, ghost


def turned_by(found, truth):
    """Angle from each beam of the truth to what is found there, brightest first [°]."""
    middles, _ = beams(truth)
    ends = [(beam(truth, middle), beam(found, middle)) for middle in middles]
    return np.array([float(np.degrees(angle_between(*pair))) for pair in ends])


def _within_3_degrees(light):
    _, cell = cKDTree(_cells()).query(light.direction)
    flux = np.bincount(cell, light.flux, len(_cells()))
    return _disc() @ flux


@functools.cache
def _disc():
    near = cKDTree(_cells()).query_ball_point(_cells(), np.radians(3.0))
    row = np.repeat(np.arange(len(near)), [len(k) for k in near])
    column = np.concatenate([np.array(k) for k in near])
    shape = len(near), len(near)
    return sparse.csr_array((np.ones(len(row)), (row, column)), shape=shape)


@functools.cache
def _cells():
    middle = (np.arange(128) + 0.5) / 128
    a, b = (part.ravel() for part in np.meshgrid(middle, middle, indexing="ij"))
    x, y = disc_from_square(a, b)
    return np.stack([x, y, np.sqrt(np.maximum(1 - x * x - y * y, 0))], axis=-1)
