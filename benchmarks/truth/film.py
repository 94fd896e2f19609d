"""Truth behind a clear film: paths through its real prisms, sun by its own rays.

No shadow ray finds the sun through prisms. So rays of the sun are traced through the
film first, from all of its disc; what leaves the film into the room is a cloud of
directions, exact as the prisms are. Paths then run from sensors and eyes against the
light. At every matt surface of the room a path borrows the direction of one of these
rays, chosen by chance, and asks whether it arrives from the sunlit part of the window;
at every surface outdoors it asks for the sun itself. Paths meet the film as what it
is, prisms of a dielectric, from either side: sky, sunlit ground and reveal shine
through it, and the room's own light is mirrored by it. The images of the sun that an
eye sees in the film are those rays that arrive at the eye.

A film may fill a part of the window, above a blind: then the surfaces of the room ask
for the sun itself as well.

No BSDF of the film takes part, neither patches nor trees. Left out is sun that the
film mirrors back outdoors, on to the sill and the ground.
"""

from dataclasses import dataclass
from datetime import datetime

import drjit as dr
import mitsuba as mi
import numpy as np

import clerestory as cl
from clerestory.bands import RGB
from clerestory.engine.camera_rays import CameraRays
from clerestory.engine.distant_emitters import DistantEmitters
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.upload import vectors
from clerestory.engine.visibility import offset
from clerestory.image.camera import Camera
from clerestory.scene.model import Scene
from clerestory.scene.sensors import Sensors
from truth.beams import MOST, Beams, beams, borrowed, random_numbers, window_pdf
from truth.facades import Kind, Part
from truth.setting import HEIGHT, ORIGIN, WIDTH, demo
from truth.slats import PixelPaths, near_the_sun
from truth.sun_rays import direct_sun, sun_images

_LUX = RGB.weights

# Distance from the film beyond which surfaces belong to the room [m]
_FACE = 1e-4

# Share of directions that aim at the window, and when weak paths may end
_AIMED = 0.5
_FREE = 6

# Independent parts of an estimate
_PARTS = 4


@dataclass
class FilmRoom:
    """A room behind a film at one moment.

    `mixed` if a part of the window has none; `mirrors` if it reflects the room's light.
    """

    model: LoweredScene
    sky: DistantEmitters
    beams: Beams
    mixed: bool
    mirrors: bool


class Film:
    """The truth behind a film; or, if it does not mirror, without the room's light.

    View matrices leave out light of the room that the window reflects.
    """

    def __init__(self, kind: Kind, *, mirrors: bool = True):
        scene, _, _, _ = demo()
        assert kind.clear is not None
        self.part: Part = kind.clear
        self.mixed, self.mirrors = len(kind.parts) > 1, mirrors
        self.room = lower(scene + kind.geometry(), origin=ORIGIN)
        middle = np.array([*ORIGIN[:2], (self.part.low + self.part.high) / 2])
        self.film = lower(self.part.geometry(), origin=middle)
        self.known: dict[datetime, FilmRoom] = {}

    def at(self, light: Scene) -> FilmRoom:
        """Return the room under a sky with its sun."""
        sky = DistantEmitters.of(light)
        sun = beams(self.film, self.part, sky)
        return FilmRoom(self.room, sky, sun, self.mixed, self.mirrors)

    def when(self, hours: cl.Weather, moment: datetime) -> FilmRoom:
        """Return the room at a moment; it is made once."""
        if moment not in self.known:
            self.known[moment] = self.at(cl.sky_at(hours, moment))
        return self.known[moment]

    def illuminance(
        self,
        hours: cl.Weather,
        moment: datetime,
        sensors: Sensors,
        *,
        samples: int,
        seed: int,
    ) -> tuple[np.ndarray, np.ndarray]:
        """Illuminance of sensors, and its standard error [lux]."""
        lit = self.when(hours, moment)
        return estimate(lit, sensors, samples=samples, seed=seed)

    def direct_sun(
        self, hours: cl.Weather, moment: datetime, sensors: Sensors
    ) -> tuple[np.ndarray, np.ndarray]:
        """Illuminance by sun straight from the film, and its standard error [lux]."""
        return direct_sun(self.when(hours, moment).beams, self.room, sensors)

    def picture(
        self,
        hours: cl.Weather,
        moment: datetime,
        camera: Camera,
        *,
        paths: PixelPaths,
        seed: int,
    ) -> np.ndarray:
        """Radiance of a camera's pixels by independent parts (part, pixel, channel)."""
        light, lit = cl.sky_at(hours, moment), self.when(hours, moment)
        sunny = near_the_sun(light, camera) & self.mixed
        images = sun_images(lit.beams, camera, _PARTS)
        found = np.repeat(images[..., None], 3, axis=2)
        for some, samples in ((~sunny, paths.usual), (sunny, paths.sunny)):
            pixels = np.flatnonzero(some)
            if len(pixels):
                for number in range(_PARTS):
                    own = _PARTS * seed + number
                    found[number, pixels] += picture(
                        lit, camera, pixels, samples=samples // _PARTS, seed=own
                    )
        return found


def estimate(
    room: FilmRoom, sensors: Sensors, *, samples: int, seed: int
) -> tuple[np.ndarray, np.ndarray]:
    """Illuminance of sensors, and its standard error [lux]."""
    parts = [
        illuminance(room, sensors, samples=samples // _PARTS, seed=_PARTS * seed + n)
        for n in range(_PARTS)
    ]
    return np.mean(parts, axis=0), np.std(parts, axis=0, ddof=1) / np.sqrt(_PARTS)


@dr.syntax
def follow(room: FilmRoom, rng, ray, weight, sharp, active):
    """Return the light along rays; `sharp` ones are of eyes, which see the sun."""
    model, sky = room.model, room.sky
    context = mi.BSDFContext()

    # ------------------------------- Loop state -------------------------------
    light = mi.Color3f(0)
    sharp = mi.Bool(sharp)
    vertex = mi.UInt32(0)
    left = mi.Bool(False)  # whether the path has met the film, or was outdoors

    while active:
        si = model.scene.ray_intersect(ray, active)
        met = active & si.is_valid()
        inside = si.p.y > _FACE
        active &= ~met | ~left | ~inside | room.mirrors
        met &= active
        left |= met & ~inside

        # Take the sky; the sun's disc only where nothing stands between
        away = active & ~met
        sun, _ = sky.sun_radiance(ray.d, away & sharp)
        shone = sky.environment_radiance(ray.d) + dr.select(sharp, sun, 0)
        light += dr.select(away, weight * shone, 0)

        # Ask for the sun: borrowed rays of it in the room, and itself
        bsdf = si.bsdf()
        matt = met & mi.has_flag(bsdf.flags(), mi.BSDFFlags.Smooth)
        indoors = si.p.y > 0
        a, b, c = rng.next_float32(), rng.next_float32(), rng.next_float32()
        towards, irradiance, distance = borrowed(room.beams, si.p, a)
        start = offset(model, si, towards, matt)
        value = bsdf.eval(context, si, si.to_local(towards), matt) * irradiance
        asked = matt & indoors & (dr.max(value) > 0) & (distance > 1e-4)
        line = mi.Ray3f(start, towards, distance - 1e-4, 0, [])
        hidden = model.scene.ray_test(line, asked)
        light += dr.select(asked & ~hidden, weight * value, 0)
        direct = sky.sample_sun(a, b, c)
        towards = direct.direction
        start = offset(model, si, towards, matt)
        value = bsdf.eval(context, si, si.to_local(towards), matt)
        value *= direct.radiance / direct.pdf
        asked = matt & (~indoors | room.mixed) & (dr.max(value) > 0)
        hidden = model.scene.ray_test(mi.Ray3f(start, towards), asked)
        light += dr.select(asked & ~hidden, weight * value, 0)

        # Go on: towards the window, as the material proposes, or as prisms bend
        a, b, c = rng.next_float32(), rng.next_float32(), rng.next_float32()
        d, e = rng.next_float32(), rng.next_float32()
        aimed = matt & indoors
        goal = mi.Point3f((d - 0.5) * WIDTH, 0, (e - 0.5) * HEIGHT)
        to_window = aimed & (rng.next_float32() < _AIMED)
        sample, factor = bsdf.sample(context, si, a, mi.Point2f(b, c), met)
        proposed = si.to_world(sample.wo)
        onward = dr.select(to_window, dr.normalize(goal - si.p), proposed)
        local = si.to_local(onward)
        mixed = _AIMED * window_pdf(si.p, onward)
        mixed += (1 - _AIMED) * bsdf.pdf(context, si, local, aimed)
        both = bsdf.eval(context, si, local, aimed) / mixed
        weight *= dr.select(aimed, dr.select(mixed > 0, both, 0), factor)
        ray = mi.Ray3f(offset(model, si, onward, met), onward)
        sharp &= ~met

        # Let weak paths end by chance
        vertex += 1
        survive = dr.select(vertex < _FREE, 1, dr.minimum(dr.max(weight), 0.95))
        survive = dr.select(matt, survive, 1)
        active = met & (vertex < MOST) & (rng.next_float32() < survive)
        weight /= survive
        active &= dr.max(weight) > 0

    return light


def illuminance(
    room: FilmRoom, sensors: Sensors, *, samples: int, seed: int
) -> np.ndarray:
    """Illuminance of sensors [lux]."""
    count = len(sensors)
    found = _gathered(
        room,
        vectors(mi.Point3f, sensors.position - ORIGIN),
        vectors(mi.Vector3f, sensors.direction),
        dr.opaque(mi.UInt32, samples),
        count * samples,
        dr.opaque(mi.UInt32, seed),
    )
    return _means(found, count, samples) @ _LUX


def _gathered(room, position, normal, samples, lanes, seed):
    """Return what reaches sensors by single paths."""
    lane = dr.arange(mi.UInt32, lanes)
    rng = random_numbers(lane, seed)
    o = dr.gather(mi.Point3f, position, lane // samples)
    n = dr.gather(mi.Vector3f, normal, lane // samples)
    frame = mi.Frame3f(n)

    # Sun of the sensor itself, behind the film and beside it
    towards, irradiance, distance = borrowed(room.beams, o, rng.next_float32())
    cosine = dr.maximum(dr.dot(n, towards), 0)
    asked = (irradiance * cosine > 0) & (distance > 0)
    line = mi.Ray3f(o, towards, distance - 1e-4, 0, [])
    clear = asked & ~room.model.scene.ray_test(line, asked)
    light = mi.Color3f(dr.select(clear, irradiance * cosine, 0))
    a, b, c = rng.next_float32(), rng.next_float32(), rng.next_float32()
    direct = room.sky.sample_sun(a, b, c)
    cosine = dr.maximum(dr.dot(n, direct.direction), 0)
    asked = room.mixed & (cosine > 0)
    clear = asked & ~room.model.scene.ray_test(mi.Ray3f(o, direct.direction), asked)
    light += dr.select(clear, direct.radiance * cosine / direct.pdf, 0)

    # Leave towards the window, or by the cosine
    a, b = rng.next_float32(), rng.next_float32()
    goal = mi.Point3f((a - 0.5) * WIDTH, 0, (b - 0.5) * HEIGHT)
    local = mi.warp.square_to_cosine_hemisphere(mi.Point2f(a, b))
    to_window = rng.next_float32() < _AIMED
    d = dr.select(to_window, dr.normalize(goal - o), frame.to_world(local))
    cosine = dr.dot(n, d)
    pdf = _AIMED * window_pdf(o, d)
    pdf += (1 - _AIMED) * dr.maximum(cosine, 0) * dr.inv_pi
    active = cosine > 0
    weight = mi.Color3f(dr.select(active, cosine / pdf, 0))
    return light + follow(room, rng, mi.Ray3f(o, d), weight, False, active)


def picture(
    room: FilmRoom, camera: Camera, pixels: np.ndarray, *, samples: int, seed: int
) -> np.ndarray:
    """Radiance of some of a camera's pixels (pixel, channel)."""
    rays = CameraRays.of(camera.view, camera.columns, camera.rows)
    lane = dr.arange(mi.UInt32, len(pixels) * samples)
    rng = random_numbers(lane, dr.opaque(mi.UInt32, seed))
    number = lane // dr.opaque(mi.UInt32, samples)
    pixel = dr.gather(mi.UInt32, mi.UInt32(pixels.astype(np.uint32)), number)
    x, y = rng.next_float32(), rng.next_float32()
    ray, valid = rays.through(pixel, x, y)
    ray.o += vectors(mi.Vector3f, (camera.position - ORIGIN)[None])
    found = follow(room, rng, ray, mi.Color3f(1), True, valid)
    return _means(found, len(pixels), samples)


def _means(found: mi.Color3f, rows: int, samples: int) -> np.ndarray:
    total = dr.block_reduce(dr.ReduceOp.Add, found, samples)
    return np.array(total).T.reshape(rows, 3).astype(float) / samples
