"""Direct sun through a window: C_ds, from suns to sensors, without any interreflection.

For each sensor and sun, points of the window are connected to both, and directions
are drawn from the lobes into which the window's BSDF scatters this very sun; both
share the work by multiple importance sampling. So a smooth blind and a film with
lobes of a degree cost the same. What the BSDF passes straight, if asked for, is a
term of its own, sharp as the sun.

Reference: A. McNeil, The five-phase method for simulating complex fenestration with
Radiance, LBNL, 2013.
"""

from dataclasses import dataclass

import drjit as dr
import mitsuba as mi
import numpy as np
from jaxtyping import Float

from clerestory.bsdf.bsdf import Bsdf
from clerestory.engine import sampler
from clerestory.engine.direct_sun_jobs import SunJob
from clerestory.engine.lower import LoweredScene, lower
from clerestory.engine.materials.bsdf_file import forward_table
from clerestory.engine.next_event_estimation import Draw
from clerestory.engine.peak_extraction import PeakTable
from clerestory.engine.sampler import Points, points
from clerestory.engine.upload import launching, on_device, vectors
from clerestory.engine.walk import towards
from clerestory.engine.windows import WindowTable, window_shapes
from clerestory.engine.work_units import Tracer, Unit
from clerestory.scene.model import Scene
from clerestory.scene.window import Window

# Half the sun's apparent diameter, as 1 − cos
_DEPTH = 2 * float(np.sin(np.radians(0.533) / 4)) ** 2


@dataclass
class SunWindow:
    """One window with its BSDF, and what stands on either side.

    Attributes
    ----------
    inside : the scene with all windows, which end the light of the room side
    outside : the scene without windows
    own : table of this window
    role : its number among the windows, plus one
    table : its BSDF, drawn from for light that comes from the sun
    peak : what passes straight, kept apart; None: part of the table
    """

    inside: LoweredScene
    outside: LoweredScene
    own: WindowTable
    role: int
    table: object
    peak: PeakTable | None

    @classmethod
    def of(
        cls,
        scene: Scene,
        windows: tuple[Window, ...],
        number: int,
        bsdf: Bsdf,
        *,
        peak: bool,
        origin: Float[np.ndarray, "3"],
    ) -> "SunWindow":
        """Return the window with the given number among all windows of a scene."""
        own, _ = window_shapes((windows[number],), origin)
        return cls(
            inside=lower(scene, origin=origin, receivers=windows),
            outside=lower(scene, origin=origin),
            own=own,
            role=number + 1,
            table=forward_table(bsdf),
            peak=PeakTable(bsdf) if peak else None,
        )

    def sees(self, point, sun, active):
        """Return whether the sun shines on a point of the window from outside."""
        normal = self.own.to_scene(mi.UInt32(0), mi.Vector3f(0, 0, 1))
        reach = dr.max(dr.abs(point))
        start = point - normal * (4e-6 * dr.maximum(reach, 0.05))
        lit = active & (dr.dot(normal, sun) < 0)
        return lit & ~self.outside.scene.ray_test(mi.Ray3f(start, sun), lit)

    def transmitted(self, direction, sun):
        """Return the BTDF for light from the sun along a direction, and its density.

        The density is that of drawing the direction from the sun's lobes [1/sr].
        """
        leaving = self.own.to_local(mi.UInt32(0), direction)
        incident = self.own.to_local(mi.UInt32(0), sun)
        value, density = self.table.evaluate(mi.UInt32(0), leaving, incident)
        value = self.table.colour(value)
        if self.peak is not None:
            value = self.peak.without(value, leaving, incident)
        return value, density * dr.maximum(leaving.z, 0)

    def lobe(self, sun, u, v):
        """Return a direction drawn from the lobes of the sun's light."""
        incident = self.own.to_local(mi.UInt32(0), sun)
        disc, _, _ = self.table.sample(mi.UInt32(0), incident, u, v)
        height = dr.safe_sqrt(1 - dr.squared_norm(disc))
        return self.own.to_scene(mi.UInt32(0), mi.Vector3f(disc.x, disc.y, height))

    def straight(self, sun):
        """Return the share of the sun's light that passes straight."""
        if self.peak is None:
            return mi.Color3f(0)
        leaving = self.own.to_local(mi.UInt32(0), -sun)
        return dr.select(leaving.z > 0, self.peak.transmittance(leaving), 0)


@dataclass
class Place:
    """Where sunlight is received, and how much of it counts.

    Attributes
    ----------
    point : [m], on the room side
    leave : function that returns the point moved off its surface towards a direction
    receive : function that returns what counts of light from a direction, cosine
        included
    """

    point: mi.Point3f
    leave: object
    receive: object


def on_disc(sun, a, b):
    """Return a direction to the disc of a sun; a, b lie in the unit square."""
    height = a * _DEPTH
    flat = dr.sqrt(height * (2 - height))
    sine, cosine = dr.sincos(2 * dr.pi * b)
    local = mi.Vector3f(flat * cosine, flat * sine, 1 - height)
    return mi.Frame3f(sun).to_world(local)


def sunlight(window: SunWindow, place: Place, sun, draw, active):
    """Light of the sun through the window, one sample per direct normal irradiance.

    Parameters
    ----------
    sun : unit vector to a point of the sun
    draw : function that returns sample numbers by purpose
    """
    light = _by_window(window, place, sun, draw, active)
    light += _by_lobe(window, place, sun, draw, active)
    if window.peak is not None:
        light += _straight(window, place, sun, active)
    return light


def _by_window(window: SunWindow, place: Place, sun, draw, active):
    # Connect with a point of the window
    own, inside = window.own, window.inside
    facing = own.to_scene(mi.UInt32(0), mi.Vector3f(0, 0, 1))
    u, v = draw(sampler.CONNECT_U), draw(sampler.CONNECT_V)
    point, _, spherical = own.aim(place.point, u, v)
    across = point - place.point
    distance2 = dr.squared_norm(across)
    direction = across * dr.rsqrt(distance2)
    behind = -dr.dot(direction, facing)
    by_area = distance2 / (dr.maximum(behind, 1e-6) * own.area)
    pdf = dr.select(spherical > 0, spherical, by_area)
    value, density = window.transmitted(-direction, sun)
    value *= place.receive(direction)
    lit = active & (behind > 1e-6) & (dr.max(value) > 0)
    lit &= ~inside.scene.ray_test(towards(place.leave(direction, lit), point), lit)
    lit &= window.sees(point, sun, lit)
    slant = dr.maximum(-dr.dot(sun, facing), 0)
    return dr.select(lit, value * (slant / (pdf + density)), 0)


def _by_lobe(window: SunWindow, place: Place, sun, draw, active):
    # Look back along a direction that the sun's light takes
    own = window.own
    facing = own.to_scene(mi.UInt32(0), mi.Vector3f(0, 0, 1))
    u, v = draw(sampler.DIRECTION_U), draw(sampler.DIRECTION_V)
    leaving = window.lobe(sun, u, v)
    value, density = window.transmitted(leaving, sun)
    value *= place.receive(-leaving)
    lit = active & (dr.max(value) > 0)
    si, lit = _window_along(window, place, -leaving, lit)
    behind = dr.dot(leaving, facing)
    element = si.prim_index >> 1
    spherical = own.spherical_pdf(element, own.look(place.point, element))
    by_area = dr.square(si.t) / (dr.maximum(behind, 1e-6) * own.area)
    pdf = dr.select(spherical > 0, spherical, by_area)
    lit &= window.sees(si.p, sun, lit)
    slant = dr.maximum(-dr.dot(sun, facing), 0)
    return dr.select(lit, value * (slant / (pdf + density)), 0)


def _straight(window: SunWindow, place: Place, sun, active):
    # Look at the sun itself
    value = window.straight(sun) * place.receive(sun)
    si, lit = _window_along(window, place, sun, active & (dr.max(value) > 0))
    lit &= window.sees(si.p, sun, lit)
    return dr.select(lit, value, 0)


def _window_along(window: SunWindow, place: Place, direction, active):
    # What a ray meets, and whether it is the window
    inside = window.inside
    ray = mi.Ray3f(place.leave(direction, active), direction)
    hit = inside.scene.ray_intersect_preliminary(ray, active=active)
    si = hit.compute_surface_interaction(ray, mi.RayFlags.Minimal, active)
    shape = dr.reinterpret_array(mi.UInt32, si.shape)
    met = active & hit.is_valid()
    role = dr.gather(mi.UInt32, inside.window_of_shape, shape, met)
    return si, met & (role == window.role)


@dr.syntax
def sunlight_at(
    window: SunWindow,
    sequence: Points,
    place: Place,
    sun,
    seed,
    active,
):
    """Irradiance at a place per direct normal irradiance of a sun behind the window.

    Parameters
    ----------
    sun : unit vector to the middle of the sun
    """
    light = mi.Color3f(0)
    index = mi.UInt32(0)
    while active & (index < sequence.stride):
        a = sampler.random_number(seed, index, mi.UInt32(1))
        b = sampler.random_number(seed, index, mi.UInt32(2))
        light += sunlight(
            window,
            place,
            on_disc(sun, a, b),
            Draw(sequence, seed, index, mi.UInt32(0)).number,
            active,
        )
        index += 1
    return light / mi.Float(sequence.stride)


def prepare_sun(job: SunJob) -> Tracer:
    """Return what traces direct sun to sensors."""
    origin = np.mean(job.sensors.position, axis=0)
    window = SunWindow.of(
        job.scene, job.windows, job.number, job.bsdf, peak=job.peak, origin=origin
    )
    sequence = points(0, job.points)
    position = vectors(mi.Point3f, job.sensors.position - origin)
    normal = vectors(mi.Vector3f, job.sensors.direction)

    _, batches, _, channels = job.shape

    def trace(unit: Unit) -> Float[np.ndarray, "row batch sun channel"]:
        rows, suns = len(unit.rows), len(unit.columns)
        lane = dr.arange(mi.UInt32, rows * suns * batches)
        pair = lane // batches
        row = pair // dr.opaque(mi.UInt32, suns) + dr.opaque(
            mi.UInt32, int(unit.rows[0])
        )
        sun = pair % dr.opaque(mi.UInt32, suns)
        number = dr.gather(mi.UInt32, on_device(mi.UInt32, unit.columns), sun)
        stream = sampler.mix(number, dr.opaque(mi.UInt32, job.seed))
        key = mi.sample_tea_32(row * batches + lane % batches, stream)[0]
        middle = vectors(mi.Vector3f, job.suns[unit.columns])
        with launching():
            light = sunlight_at(
                window,
                sequence,
                _sensor_place(position, normal, row),
                dr.gather(mi.Vector3f, middle, sun),
                key,
                mi.Bool(True),
            )
            dr.eval(light)
            values = light.numpy()
        by_pair = values.T.reshape(rows, suns, batches, 3)[..., :channels]
        return by_pair.transpose(0, 2, 1, 3).astype(float)

    return trace


def _sensor_place(position, normal, row) -> Place:
    point = dr.gather(mi.Point3f, position, row)
    upwards = dr.gather(mi.Vector3f, normal, row)
    return Place(
        point,
        lambda direction, active: point,
        lambda direction: mi.Color3f(dr.maximum(dr.dot(upwards, direction), 0)),
    )
