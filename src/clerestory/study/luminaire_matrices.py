"""Electric light of a study, traced once at full output and dimmed per time step.

When electric light is traced, windows are black and light sources of the room are off.
"""

from dataclasses import dataclass, field
from functools import partial
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.errors import located
from clerestory.formats.photometry.luminaire_scene import luminaire_scene
from clerestory.formats.photometry.read import read_luminaire
from clerestory.image.camera import Camera
from clerestory.matrix.axis import pixel_axis, sensor_axis, unknown_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.rendering import irradiance, render
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.band_conversion import emitting
from clerestory.scene.material import altered
from clerestory.scene.model import Emitter, Illum, Material, Plastic, Scene
from clerestory.scene.scaling import scaled
from clerestory.scene.sensors import Sensors
from clerestory.spectral.alpha_opic import edi_weights
from clerestory.spectral.band_sets import gives
from clerestory.spectral.spectrum_file import read_spectrum
from clerestory.study.job import LAMPS, Job
from clerestory.study.lighting_tables import LightingTable, LuminaireTable


@dataclass(frozen=True, eq=False)
class Zone:
    """Lighting zone: its luminaires, and their electric power at full output [W]."""

    table: LightingTable
    light: Scene
    power: float


@dataclass(frozen=True, eq=False)
class Lamps:
    """Illuminance and pixel radiance due to each lighting zone at full output.

    `views` has the radiance (pixel, channel) due to each zone, by view name.
    `melanopic` is the melanopic EDI, and `spectra` the irradiance in bands; None unless
    all luminaires have spectra.
    """

    zones: tuple[Zone, ...] = ()
    illuminance: Float[np.ndarray, "zone sensor"] = field(
        default_factory=lambda: np.zeros((0, 0))
    )
    views: dict[str, tuple[np.ndarray, ...]] = field(default_factory=dict)
    melanopic: Float[np.ndarray, "zone sensor"] | None = None
    spectra: Float[np.ndarray, "zone band sensor"] | None = None


def trace_lamps(job: Job) -> Lamps:
    """Return the electric light of all lighting zones, from the cache if possible."""
    zones = tuple(_zone(job, table) for table in job.study.lighting)
    if not zones:
        return Lamps()
    room = unlit(job.scene)
    light = [_sensors(job, room, zone, n) for n, zone in enumerate(zones)]
    lux = np.stack([_weighted(one, one.bands.weights) for one in light])
    melanopic, spectra, bands = None, None, room.bands
    spectral = all(lamp.spectrum is not None for lamp in job.study.luminaire)
    if spectral and gives(bands, "melanopic"):
        weights = edi_weights(bands, "melanopic")
        melanopic = np.stack([_weighted(one, weights) for one in light])
        spectra = np.stack([_in_bands(one) for one in light])
    views = {
        table.label: tuple(
            _pixels(job, room, zone, n, view) for n, zone in enumerate(zones)
        )
        for view, table in enumerate(job.study.view)
    }
    return Lamps(zones, lux, views, melanopic, spectra)


def unlit(scene: Scene) -> Scene:
    """Return a copy of a scene with black light sources, without sky and sun."""

    def dark(material: Material) -> Material:
        if isinstance(material, Illum):
            return dark(altered(material.alternate, name=material.name))
        if isinstance(material, Emitter):
            return Plastic(material.name, np.zeros(len(scene.bands)))
        return material

    materials = {name: dark(material) for name, material in scene.materials.items()}
    return Scene(materials, scene.surfaces, bands=scene.bands)


def _zone(job: Job, table: LightingTable) -> Zone:
    light, power = Scene(), 0.0
    for lamp in job.study.luminaire:
        if lamp.zone == table.label or not lamp.zone:
            part, watts = _luminaires(lamp, job.study.scene.metres)
            if lamp.spectrum is not None:
                with located(file=lamp.spectrum):
                    spectrum = read_spectrum(lamp.spectrum)
                    part = emitting(part, spectrum, job.scene.bands)
            light, power = light + part, power + watts
    message = f'lighting "{table.label}" has no luminaires; one or more expected'
    require(light.surfaces, message)
    return Zone(table, light, power)


def _luminaires(table: LuminaireTable, metres: float) -> tuple[Scene, float]:
    # Light-emitting surfaces and their electric power [W]
    if not table.photometric:
        return _emitters(table, metres), table.power or 0.0
    lamp = read_luminaire(table.file)
    light = Scene()
    for number, place in enumerate(table.places, start=1):
        light += luminaire_scene(
            lamp,
            position=metres * np.array(place, dtype=float),
            turn_deg=table.turn_deg,
            tilt_deg=table.tilt_deg,
            dimming=table.output,
            name=f"{table.label}.{number}",
        )
    power = lamp.watts * len(table.places) if table.power is None else table.power
    require(
        power > 0,
        f'the file of luminaire "{table.label}" has no power; the key "power" expected',
        file=table.file,
    )
    return light, power


def _emitters(table: LuminaireTable, metres: float) -> Scene:
    scene = scaled(read_rad(table.file), metres)
    materials = dict(scene.materials)
    emitters = {name for name, each in materials.items() if isinstance(each, Emitter)}
    for name, material in scene.materials.items():
        if isinstance(material, Emitter):
            radiance = table.output * material.radiance
            materials[name] = altered(material, radiance=radiance)
    require(
        any(surface.material in emitters for surface in scene.surfaces),
        "contains no surface that emits light; a light or glow expected",
        file=table.file,
    )
    return Scene(materials, scene.surfaces, bands=scene.bands)


def _sensors(job: Job, room: Scene, zone: Zone, number: int) -> TransferMatrix:
    name = zone.table.label
    return job.matrix(
        f"lamps-{name}",
        partial(_sensor_matrix, room + zone.light, job.inputs.sensors()),
        job.effort(LAMPS + number),
        shown=f"electric light of {name or 'the room'}",
    )


def _weighted(
    light: TransferMatrix, weights: Float[np.ndarray, " band"]
) -> Float[np.ndarray, " sensor"]:
    return np.asarray(light.weighted(weights).values[0, :, 0])


def _in_bands(light: TransferMatrix) -> Float[np.ndarray, "band sensor"]:
    # A grey room has one channel for all bands
    values = light.values[:, :, 0]
    return np.broadcast_to(values, (len(light.bands), values.shape[1]))


def _sensor_matrix(scene: Scene, sensors: Sensors, **how: Any) -> TransferMatrix:
    found = irradiance(scene, sensors, **how)
    return TransferMatrix(
        found.irradiance.T[:, :, None],
        sensor_axis(len(sensors)),
        unknown_axis(1),
        found.error.T[None, :, :, None],
        found.bands,
    )


def _pixels(job: Job, room: Scene, zone: Zone, number: int, view: int) -> np.ndarray:
    table = job.study.view[view]
    matrix = job.matrix(
        f"lamps-{table.label}-{zone.table.label}",
        partial(_pixel_matrix, room + zone.light, job.inputs.cameras[view]),
        job.pixel_effort(table.samples, LAMPS + number),
        shown=f"electric light in {table.label}",
    )
    return matrix.values[:, :, 0].T


def _pixel_matrix(scene: Scene, camera: Camera, **how: Any) -> TransferMatrix:
    columns, rows = camera.columns, camera.rows
    picture = render(scene, camera.view, columns=columns, rows=rows, **how).picture
    values = np.moveaxis(picture.radiance, -1, 0).reshape(-1, len(camera), 1)
    axes = pixel_axis(len(camera)), unknown_axis(1)
    return TransferMatrix(values, *axes, bands=picture.bands)
