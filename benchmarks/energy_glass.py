"""Solar radiation through a window by our matrices and by EnergyPlus, hour by hour.

A window of 3 m² with clear double glazing faces south, without obstructions. EnergyPlus
has the panes as ordinary glazing, whose angular properties it computes itself, and as a
complex fenestration state, also with a blind. The causes of differences are separated:
the sun within the hour, by runs with one time step and with four; sky and ground on the
window; the transmittance for the sun and for diffuse radiation, with the radiation that
EnergyPlus has on the window. The tables of `docs/benchmarks/energy.md` are made by

    python benchmarks/energy_glass.py chicago.epw
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.energyplus.building_model import read_building_model
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.complex_optics import complex_optics
from clerestory.energyplus.engine_run import AnnualRun, Output, simulate
from clerestory.energyplus.input_objects import as_idf
from clerestory.glazing.stack import stack_layers
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.patch_interpolation import patch_weights
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.sky.sky_conditions import sun_over
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.solar_at_windows import incident_radiation, sunlight

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from energy_models import (
    PANE,
    PLAIN,
    SMALL_OFFICE,
    blind,
    double_glazing,
    shaded_glazing,
)
from slat_walk import pane_pair, transmitted

OUTPUTS = {
    "beam": "Surface Outside Face Incident Beam Solar Radiation Rate per Area",
    "sky": "Surface Outside Face Incident Sky Diffuse Solar Radiation Rate per Area",
    "ground": "Surface Outside Face Incident Ground Diffuse Solar Radiation Rate per"
    " Area",
    "cosine": "Surface Outside Face Beam Solar Incident Angle Cosine Value",
    "beam in": "Surface Window Transmitted Beam Solar Radiation Rate",
    "diffuse in": "Surface Window Transmitted Diffuse Solar Radiation Rate",
}
AREA = 3.0

# Least radiation of an hour [W/m²], and hours of random walks
DIM, WALKS = 20.0, 200

# By default, EnergyPlus uses the mean solar positions of 20 days
EVERY_STEP = "ShadowCalculation,PolygonClipping,Timestep;"
SYSTEMS = {
    "clear": double_glazing(),
    "blind": shaded_glazing(45),
}
STUDY = """
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
ROOM = """void plastic grey 0 0 5 .5 .5 .5 0 0
grey polygon floor 0 0 12 0 0 0 4 0 0 4 5 0 0 5 0
"""
WINDOW = """void glow south 0 0 4 1 1 1 0
south polygon pane 0 0 12 3 0 1 1 0 1 1 0 2.5 3 0 2.5
"""


def theirs(folder, weather, construction, objects, steps):
    """Return hourly outputs of EnergyPlus for a construction, by name."""
    path = folder / f"{construction}.idf"
    text = SMALL_OFFICE.text(construction, objects, EVERY_STEP)
    path.write_text(text.replace("Timestep,4", f"Timestep,{steps}"))
    model = read_building_model(path).objects
    asked = [Output(name, "South Window") for name in OUTPUTS.values()]
    values = simulate(AnnualRun(model, weather, [], asked))
    return dict(zip(OUTPUTS, values, strict=True))


class Ours:
    """Radiation on the window by patch, that of the sun alone, and of the ground."""

    def __init__(self, folder, weather, partition):
        (folder / "room.rad").write_text(ROOM)
        (folder / "window.rad").write_text(WINDOW)
        (folder / "desk.pts").write_text("2 2 .8 0 0 1\n")
        (folder / "study.toml").write_text(STUDY.format(weather=weather.resolve()))
        study = cl.read_study(folder / "study.toml")
        inputs = read_inputs(study)
        job = Job(study, inputs, MatrixStore(folder / "matrices"), silent)
        self.partition = partition
        self.beam = sunlight(job, 0, partition)
        self.rest = incident_radiation(job, 0, partition) - self.beam
        suns = sun_over(inputs.weather, rotation_deg=0).directions()
        level = inputs.weather.direct_normal * np.maximum(suns[:, 2], 0)
        whole = level + inputs.weather.diffuse_horizontal
        self.ground = study.sky.ground_reflectance * whole / 2
        frame = inputs.groups[0].outer.frame
        self.travel = -suns @ np.array([frame.right, frame.up, frame.normal]).T

    def through(self, optics, found):
        """Transmitted radiation, with EnergyPlus' radiation on the window [W]."""
        sun, rest = self.beam.sum(axis=0), self.rest.sum(axis=0)
        share = optics.transmittance @ self.beam / np.maximum(sun, 1e-9)
        diffuse = optics.transmittance @ self.rest / np.maximum(rest, 1e-9)
        outside = found["sky"] + found["ground"]
        return AREA * share * found["beam"], AREA * diffuse * outside


def compare(name, found, expected, lit):
    """Print mean difference, and share of hours and of radiation within 3 %."""
    ratio = found[lit] / expected[lit] - 1
    weight = expected[lit] / expected[lit].sum()
    near = np.abs(ratio) < 0.03
    print(
        f"| {name} | {100 * (found[lit].sum() / expected[lit].sum() - 1):+.1f} % |"
        f" {100 * (weight @ np.abs(ratio)):.1f} % |"
        f" {100 * weight[near].sum():.0f} % | {100 * near.mean():.0f} % |"
        f" {100 * np.abs(ratio).max():.1f} % |",
        flush=True,
    )


def outdoors(ours, found, steps):
    """Print rows of the radiation on the window."""
    title = f"{steps} time step{'s' if steps > 1 else ''} in the hour"
    sun, rest = ours.beam.sum(axis=0), ours.rest.sum(axis=0)
    whole = found["beam"] + found["sky"] + found["ground"]
    compare(f"sun, {title}", sun, found["beam"], found["beam"] > DIM)
    if steps == 1:
        lit = whole > DIM
        compare("ground", ours.ground, found["ground"], lit & (found["ground"] > 1))
        compare("sky", rest - ours.ground, found["sky"], lit)
    compare(f"all, {title}", sun + rest, whole, whole > DIM)


def indoors(ours, optics, found, name):
    """Print rows of the transmitted radiation, with the same on the window."""
    outside = found["sky"] + found["ground"]
    lit, sunny = found["beam"] + outside > DIM, found["beam"] > DIM
    beam, diffuse = ours.through(optics, found)
    whole = found["beam in"] + found["diffuse in"]
    compare(f"{name}: sun", beam, found["beam in"], sunny)
    compare(f"{name}: diffuse", diffuse, found["diffuse in"], lit)
    compare(f"{name}: all", beam + diffuse, whole, lit)
    return beam, diffuse, whole, lit


def glass(ours, optics, found, name):
    """Print rows of clear glass, without differences of methods one by one."""
    beam, _, whole, lit = indoors(ours, optics, found, name)
    share = optics.partition.projected_solid_angles() / np.pi
    mean = float(optics.transmittance @ share)
    same = AREA * mean * (found["sky"] + found["ground"])
    compare(f"{name}: all, one diffuse transmittance", beam + same, whole, lit)
    cosine = np.clip(found["cosine"], 1e-3, 1)
    exact = AREA * pane_pair(PANE.material)(cosine)[0] * found["beam"]
    text = f"{name}: all, one diffuse transmittance, sun by Fresnel's equations"
    compare(text, exact + same, whole, lit)


def walks(ours, optics, found):
    """Print errors of the sun's transmittance through a blind, by random walks."""
    sunny = np.flatnonzero((found["beam"] > DIM) & (ours.beam.sum(axis=0) > 0))
    chosen = np.random.default_rng(1).choice(sunny, WALKS, replace=False)
    way, panes = ours.travel[chosen], pane_pair(PANE.material)
    slats = {"slats": blind(45).slats, "reflectance": 0.7, "gap": 0.05}
    walked = np.array([transmitted(each, panes, **slats) for each in way])
    print("\n| sun through the blind | year | mean of hours | within 3 % |")
    print("|---|---|---|---|")
    beam = found["beam"][chosen] / found["beam"][chosen].sum()
    for name, share in (
        ("ours", optics.transmittance @ patch_weights(optics.partition, way)),
        ("EnergyPlus", found["beam in"][chosen] / (AREA * found["beam"][chosen])),
    ):
        ratio = share / walked - 1
        near = 100 * np.mean(np.abs(ratio) < 0.03)
        year = 100 * (beam @ share / (beam @ walked) - 1)
        mean = 100 * (beam @ np.abs(ratio))
        print(f"| {name} | {year:+.1f} % | {mean:.1f} % | {near:.0f} % |")


def main():
    """Print the tables."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("weather", type=Path)
    parser.add_argument("--basis", default="full")
    args = parser.parse_args()
    head = "| year | mean of hours | radiation within 3 % | hours | largest |"
    with tempfile.TemporaryDirectory() as place:
        folder, partition = Path(place), klems(args.basis)
        lights = {
            name: stack_layers(one.layers, partition=partition, method="bands")
            for name, one in SYSTEMS.items()
        }
        objects = {"plain": PLAIN} | {
            name: as_idf(complex_fenestration(SYSTEMS[name], light))
            for name, light in lights.items()
        }
        write_bsdf(folder / "clear.xml", lights["clear"].bsdf)
        four = theirs(folder, args.weather, "plain", PLAIN, 4)
        found = {
            name: theirs(folder, args.weather, name, text, 1)
            for name, text in objects.items()
        }
        optics = {
            name: complex_optics(read_building_model(folder / f"{name}.idf"), name)
            for name in lights
        }
        ours = Ours(folder, args.weather, partition)
        print(f"| on the window {head}\n|---|---|---|---|---|---|")
        outdoors(ours, four, 4)
        outdoors(ours, found["plain"], 1)
        print(f"\n| transmitted, same on the window {head}\n|---|---|---|---|---|---|")
        glass(ours, optics["clear"], found["plain"], "clear, ordinary glazing")
        indoors(ours, optics["clear"], found["clear"], "clear, state")
        indoors(ours, optics["blind"], found["blind"], "blind, state")
        walks(ours, optics["blind"], found["blind"])


if __name__ == "__main__":
    main()
