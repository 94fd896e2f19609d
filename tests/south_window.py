"""Solar radiation of a south window by EnergyPlus and by ours: tests and benchmarks.

The window of 3 m² in SMALL_OFFICE has no obstructions. EnergyPlus has the position of
the sun at every time step; by default, it uses mean positions of 20 days.
"""

import numpy as np

from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.engine_run import Output
from clerestory.energyplus.input_objects import as_idf
from clerestory.glazing.stack import stack_layers
from clerestory.hemisphere.patch_interpolation import patch_weights
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.solar_at_windows import incident_radiation, sunlight
from energy_models import (
    SMALL_OFFICE,
    annual_outputs,
    double_glazing,
    shaded_glazing,
)

AREA = 3.0

# Least radiation of an hour that is compared [W/m²]
DIM = 20.0

OUTPUTS = {
    "beam": "Surface Outside Face Incident Beam Solar Radiation Rate per Area",
    "sky": "Surface Outside Face Incident Sky Diffuse Solar Radiation Rate per Area",
    "ground": "Surface Outside Face Incident Ground Diffuse Solar Radiation Rate per"
    " Area",
    "cosine": "Surface Outside Face Beam Solar Incident Angle Cosine Value",
    "beam in": "Surface Window Transmitted Beam Solar Radiation Rate",
    "diffuse in": "Surface Window Transmitted Diffuse Solar Radiation Rate",
}
SUN = {"altitude": "Site Solar Altitude Angle", "azimuth": "Site Solar Azimuth Angle"}
_EVERY_STEP = "ShadowCalculation,PolygonClipping,Timestep;"

_STUDY = """
method = "5-phase"
[scene]
files = ["room.rad"]
[[window]]
name = "south"
file = "window.rad"
bsdf = "clear.xml"
[[sensors]]
file = "desk.pts"
[weather]
file = "{weather}"
[sky]
subdivision = 4
[trace]
relative_error = 0.01
"""
_ROOM = """void plastic grey 0 0 5 .5 .5 .5 0 0
grey polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0
"""
_WINDOW = """void glow south 0 0 4 1 1 1 0
south polygon pane 0 0 12 3 0 1 1 0 1 1 0 2.5 3 0 2.5
"""


def systems(partition):
    """Clear glass without and with a blind of 45°: optical properties, and IDF text."""
    found = {}
    for system in (double_glazing(), shaded_glazing(45)):
        light = stack_layers(system.layers, partition=partition, method="bands")
        found[system.name] = light, as_idf(complex_fenestration(system, light))
    return found


def by_energyplus(folder, weather, construction, objects, *, steps=1):
    """Hourly solar radiation of the window by EnergyPlus, by name."""
    text = SMALL_OFFICE.text(construction, objects, _EVERY_STEP)
    text = text.replace("Timestep,4", f"Timestep,{steps}")
    asked = [Output(name, "South Window") for name in OUTPUTS.values()]
    asked += [Output(name, "Environment") for name in SUN.values()]
    values = annual_outputs(folder, weather, text, asked)
    return dict(zip([*OUTPUTS, *SUN], values, strict=True))


def travel(found):
    """Directions in which sunlight travels: to the right, up, and into the room."""
    altitude, azimuth = (np.radians(found[name]) for name in SUN)
    # The window faces south; azimuths are measured from north to east
    level = np.cos(altitude)
    return np.stack(
        [level * -np.sin(azimuth), -np.sin(altitude), level * -np.cos(azimuth)], axis=1
    )


def transmittance(light):
    """Solar transmittance by incident patch."""
    return light.direct_hemispherical("transmission_front", channel="solar")


def hemispherical(partition, transmitted):
    """Transmittance of radiation that is equal from all directions."""
    return float(transmitted @ partition.projected_solid_angles() / np.pi)


def at_cosine(partition, transmitted, cosine):
    """Transmittance interpolated between patches, of a window without a blind."""
    way = np.stack([0 * cosine, -np.sqrt(1 - cosine**2), cosine], axis=1)
    return transmitted @ patch_weights(partition, way)


class Ours:
    """Radiation on the window by ours: of the sun, of sky and ground, of the ground.

    `conditions` are those of the sky, `travel` the directions of sunlight.
    """

    def __init__(self, folder, weather, light, partition):
        """Write a study with the window, and trace its matrices."""
        (folder / "room.rad").write_text(_ROOM)
        (folder / "window.rad").write_text(_WINDOW)
        (folder / "desk.pts").write_text("2 2 .8 0 0 1\n")
        (folder / "study.toml").write_text(_STUDY.format(weather=weather.resolve()))
        write_bsdf(folder / "clear.xml", light.bsdf)
        study = read_study(folder / "study.toml")
        inputs = read_inputs(study)
        job = Job(study, inputs, MatrixStore(folder / "matrices"), silent)
        self.job = job
        self.beam = sunlight(job, 0, partition)
        self.rest = incident_radiation(job, 0, partition).patches - self.beam.patches
        self.weather = inputs.weather
        self.conditions = sky_conditions(self.weather, spectrum="solar")
        level = self.conditions.direct_horizontal() + self.weather.diffuse_horizontal
        self.ground = study.sky.ground_reflectance * level / 2
        frame = inputs.groups[0].outer.frame
        suns = self.conditions.sun.directions()
        self.travel = -suns @ np.array([frame.right, frame.up, frame.normal]).T
