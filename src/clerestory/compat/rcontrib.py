"""rcontrib: coefficients of suns that are light sources of the scene.

The suns are in the bins of Reinhart's sky (-f reinhart.cal -e MF:n -b rbin -m NAME), or
each has its own modifier (-M FILE, or several -m). Coefficients are irradiance or
radiance per radiance of a sun. Sunlight is direct, or scattered once (-ab 1).

References: G. Ward, manual page of rcontrib(1).
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float, Int

from clerestory.checks import require
from clerestory.compat.ray_input import RAY_OPTIONS, RayOptions, Table, write_columns
from clerestory.compat.streams import Streams
from clerestory.compat.visible_surfaces import by_surface
from clerestory.compat.words import IGNORED, Grammar, Word
from clerestory.constants import SUN_DIAMETER
from clerestory.engine.effort import Effort
from clerestory.files import read_text
from clerestory.hemisphere.reinhart import reinhart
from clerestory.phases.sky_views import sun_disc, sun_view_coefficients
from clerestory.phases.unscattered_light import unscattered_sun
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.materials.glass import Glass
from clerestory.scene.model import Plastic, Scene
from clerestory.scene.ray_bundles import RayBundles
from clerestory.scene.sensors import Sensors

PROGRAM = "rcontrib"
_OPTIONS = {**IGNORED, **RAY_OPTIONS}
_OPTIONS |= dict.fromkeys(("-m", "-M", "-b", "-bn", "-e", "-f", "-p"), 1)
_GRAMMAR = Grammar(PROGRAM, _OPTIONS, ("-f",))

# Largest deviation of the diameter of a sun [°]
_ANGLE_DEG = 0.001

_SUN_SR = 2 * np.pi * (1 - np.cos(SUN_DIAMETER / 2))

# Least number of suns in each block of pictures, and number of its coefficients
_BLOCK, _ENTRIES = 64, 1 << 20

# Columns of the coefficients: the index of a bin for each sun, and the number of bins
_Bins = tuple[Int[np.ndarray, " sun"], int]


def rcontrib(words: Sequence[str], streams: Streams) -> None:
    """Run rcontrib with the words of its command line."""
    call = _parse(words)
    scene = read_rad(call.octree)
    names = [source.material for source in scene.distant]
    unknown = sorted(set(call.modifiers) - set(names))
    require(
        not unknown,
        f"{PROGRAM}: modifier {', '.join(unknown)[:80]!r} has no source; modifiers of"
        " suns in the octree expected",
        file=call.octree,
    )
    suns = [s for s in scene.distant if s.material in set(call.modifiers)]
    wide = max(abs(s.angle_deg - np.degrees(SUN_DIAMETER)) for s in suns)
    require(
        wide < _ANGLE_DEG,
        f"{PROGRAM}: the diameter of a sun differs by {wide:.3g}° from 0.533°; suns of"
        " 0.533° expected",
        file=call.octree,
    )
    directions = np.array([sun.direction for sun in suns])
    dark = replace(scene, distant=())
    bins = call.bins(directions, [sun.material for sun in suns])
    parts = _coefficients(dark, directions, bins, call.options, streams)
    write_columns(((None, table) for table in parts), call.options, streams)


@dataclass(frozen=True)
class _Call:
    # Options of a command line; `sky` is the function file of the bins
    options: RayOptions
    octree: str = ""
    modifiers: tuple[str, ...] = ()
    sky: str = ""
    subdivision: int = 1

    def changed(self, word: Word) -> "_Call":
        match word.name:
            case "":
                return replace(self, octree=word.text)
            case "-m":
                return replace(self, modifiers=(*self.modifiers, word.text))
            case "-M":
                given = read_text(word.text).split()
                return replace(self, modifiers=(*self.modifiers, *given))
            case "-f" if not word.joined:
                return replace(self, sky=Path(word.text).name)
            case "-e" | "-p":
                found = re.search(r"\bMF\s*[:=]\s*([1-6])\b", word.text)
                return replace(self, subdivision=int(found[1])) if found else self
            case "-b":
                known = word.text in ("rbin", "tbin", "0")
                message = (
                    f"{PROGRAM}: option is -b {word.text}; rbin, tbin or 0 expected"
                )
                require(known, message)
                return self
            case _:
                return replace(self, options=self.options.changed(word))

    def bins(self, suns: Float[np.ndarray, "sun 3"], names: list[str]) -> _Bins:
        """Return the column of each sun, and the number of columns."""
        if not self.sky:
            order = {name: n for n, name in enumerate(self.modifiers)}
            return np.array([order[name] for name in names]), len(order)
        offsets = {"reinhart.cal": 0, "tregenza.cal": 0, "reinhartb.cal": 1}
        require(
            self.sky in offsets and len(set(self.modifiers)) == 1,
            f"{PROGRAM}: bins of {self.sky} for {len(self.modifiers)} modifiers;"
            f" {', '.join(offsets)} and one modifier expected",
        )
        sky, offset = reinhart(self.subdivision), offsets[self.sky]
        return sky.find(suns) - offset, len(sky) - offset


def _parse(words: Sequence[str]) -> _Call:
    call = _Call(RayOptions(PROGRAM))
    for word in _GRAMMAR.words(words):
        call = call.changed(word)
    require(call.octree, f"{PROGRAM}: no octree given; one expected")
    require(
        call.modifiers, f"{PROGRAM}: no modifier given; -m NAME or -M FILE expected"
    )
    bounces = call.options.bounces
    require(
        bounces <= 1,
        f"{PROGRAM}: -ab is {bounces}; 0 or 1 expected, as only the direct sun is"
        " computed",
    )
    return call


def _coefficients(
    scene: Scene,
    suns: Float[np.ndarray, "sun 3"],
    bins: _Bins,
    given: RayOptions,
    streams: Streams,
) -> Iterator[Table]:
    # Columns of all bins, for pictures in blocks to limit memory
    column, count = bins
    if given.quantity == "sensor":
        receivers: Sensors | RayBundles = given.sensors(streams)
    else:
        receivers = given.bundles(streams)
    every = count
    if given.writing == "c":
        every = max(_BLOCK, _ENTRIES // max(1, len(receivers)))
    for first in range(0, count, every):
        own = (column >= first) & (column < first + every)
        width = min(every, count - first)
        values = np.zeros((3, len(receivers), width), np.float32)
        if own.any():
            found = _SUN_SR * _received(scene, receivers, suns[own], given)
            for number, place in enumerate(column[own] - first):
                values[:, :, place] += found[..., number]
        yield values
        if streams.progress is not None:
            streams.progress((first + width) / count, f"{first + width} bins")


def _received(
    scene: Scene,
    receivers: Sensors | RayBundles,
    suns: Float[np.ndarray, "sun 3"],
    given: RayOptions,
) -> Table:
    # Irradiance, or radiance [1/sr], per direct normal irradiance

    def at_sensors(sensors: Sensors) -> Table:
        found = unscattered_sun(
            scene, sensors=sensors, suns=suns, centre=given.centred
        ).values
        if not given.bounces or not _scatters(scene):
            return found
        rays = _hemispheres(sensors, given)
        scattered = sun_view_coefficients(
            scene, rays, suns=suns, samples=rays.rays, indirect=True, seed=given.seed
        )
        return np.asarray(found + np.pi * scattered.values)

    def along_rays(rays: RayBundles) -> Table:
        samples = max(4, rays.rays)
        seen = sun_view_coefficients(
            scene, rays, suns=suns, samples=samples, seed=given.seed
        ).values
        return np.asarray(seen + _discs(scene, rays, suns) / _SUN_SR)

    if isinstance(receivers, Sensors):
        return at_sensors(receivers)
    if given.quantity == "radiance":
        return along_rays(receivers)
    [(_, table)] = by_surface(
        scene, receivers, (), Effort(),
        lambda sensors, _: iter([(None, at_sensors(sensors))]),
        lambda rays, _: iter([(None, np.zeros((3, len(rays), len(suns))))]),
    )  # fmt: skip
    return table


def _scatters(scene: Scene) -> bool:
    # Whether a surface scatters light: not if all are black or clear glass
    used = {scene.materials[surface.material] for surface in scene.surfaces}
    return not all(
        isinstance(each, Glass)
        or (
            isinstance(each, Plastic)
            and not each.reflectance.any()
            and not each.specularity
        )
        for each in used
    )


def _hemispheres(sensors: Sensors, given: RayOptions) -> RayBundles:
    # Rays of each sensor, distributed by the cosine to its direction, each turned
    count = given.directions
    k, golden = np.arange(count) + 0.5, np.pi * (3 - np.sqrt(5))
    turn = np.random.default_rng(given.seed).random((len(sensors), 1))
    radius, angle = np.sqrt(k / count), golden * k + 2 * np.pi * turn
    flat = np.broadcast_to(np.sqrt(1 - radius**2), angle.shape)
    local = np.stack([radius * np.cos(angle), radius * np.sin(angle), flat], -1)
    normal = sensors.direction
    side = np.cross(normal, np.eye(3)[np.abs(normal).argmin(axis=1)])
    side /= np.linalg.norm(side, axis=1, keepdims=True)
    frame = np.stack([side, np.cross(normal, side), normal], axis=1)
    towards = np.einsum("skl,slx->skx", local, frame)
    start = np.broadcast_to(sensors.position[:, None], towards.shape)
    return RayBundles(start.copy(), towards)


def _discs(
    scene: Scene, rays: RayBundles, suns: Float[np.ndarray, "sun 3"]
) -> Float[np.ndarray, "row column"]:
    # Mean over the rays of a bundle of the transmittance to the sun that each ray meets
    found = np.zeros((len(rays), len(suns)))
    near = np.einsum("brx,sx->brs", rays.direction, suns) > np.cos(SUN_DIAMETER / 2)
    for bundle, ray, sun in np.argwhere(near):
        share, passed = sun_disc(scene, rays.origin[bundle, ray], suns[sun : sun + 1])
        found[bundle, sun] += (share * passed)[0] / rays.rays
    return found
