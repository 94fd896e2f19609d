"""Solar radiation through a window by our matrices and by EnergyPlus, hour by hour.

A window of 3 m² with clear double glazing faces south, without obstructions. EnergyPlus
has the panes as ordinary glazing, whose angular properties it computes itself, and the
same panes as a complex fenestration state. With the same beam and diffuse radiation on
the window, transmittances are compared; with the weather file alone, also the skies.
The table of `docs/benchmarks/energy.md` is made by

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
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.solar_at_windows import incident_radiation, sunlight

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from energy_models import PLAIN, SMALL_OFFICE, double_glazing, shaded_glazing

OUTPUTS = [
    Output(f"Surface {name} Solar Radiation Rate{end}", "South Window")
    for name, end in (
        ("Outside Face Incident Beam", " per Area"),
        ("Outside Face Incident", " per Area"),
        ("Window Transmitted Beam", ""),
        ("Window Transmitted", ""),
    )
]
AREA = 3.0

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


def theirs(folder, weather, construction, objects):
    """Return hourly outputs of EnergyPlus for a construction."""
    path = folder / f"{construction}.idf"
    path.write_text(SMALL_OFFICE.text(construction, objects, EVERY_STEP))
    model = read_building_model(path).objects
    return simulate(AnnualRun(model, weather, [], OUTPUTS))


def ours(folder, weather, optics):
    """Return incident and transmitted radiation, and the transmittance for the sun."""
    (folder / "room.rad").write_text(ROOM)
    (folder / "window.rad").write_text(WINDOW)
    (folder / "desk.pts").write_text("2 2 .8 0 0 1\n")
    (folder / "study.toml").write_text(STUDY.format(weather=weather.resolve()))
    study = cl.read_study(folder / "study.toml")
    inputs = read_inputs(study)
    job = Job(study, inputs, MatrixStore(folder / "matrices"), silent)
    flux = incident_radiation(job, 0, optics.partition)
    beam = sunlight(job, 0, optics.partition)
    return flux, beam


def compare(name, found, expected, lit):
    """Print mean difference, and share of the radiation in hours within 3 %."""
    ratio = found[lit] / expected[lit] - 1
    weight = expected[lit] / expected[lit].sum()
    near = weight[np.abs(ratio) < 0.03].sum()
    print(
        f"| {name} | {100 * (found[lit].sum() / expected[lit].sum() - 1):+.2f} % |"
        f" {100 * (weight @ np.abs(ratio)):.2f} % |"
        f" {100 * np.quantile(np.abs(ratio), 0.95):.1f} % | {100 * near:.1f} % |",
        flush=True,
    )


def main():
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("weather", type=Path)
    parser.add_argument("--bases", nargs="*", default=["quarter", "full"])
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        plain = theirs(folder, args.weather, "plain", PLAIN)
        print("| transmitted | year | mean | 95 % of hours | radiation within 3 % |")
        print("|---|---|---|---|---|")
        for basis in args.bases:
            lights = {
                name: stack_layers(one.layers, partition=klems(basis), method="bands")
                for name, one in SYSTEMS.items()
            }
            text = {
                name: as_idf(complex_fenestration(SYSTEMS[name], lights[name]))
                for name in lights
            }
            write_bsdf(folder / "clear.xml", lights["clear"].bsdf)
            rows = {n: theirs(folder, args.weather, n, t) for n, t in text.items()}
            for name, reference in (
                ("clear", plain),
                ("clear", rows["clear"]),
                ("blind", rows["blind"]),
            ):
                which = "ordinary glazing" if reference is plain else "state"
                model = read_building_model(folder / f"{name}.idf")
                optics = complex_optics(model, name)
                flux, beam = ours(folder, args.weather, optics)
                incident, transmitted = flux.sum(axis=0), optics.transmittance @ flux
                beam_in, whole_in = reference[:2]
                lit = whole_in > 20
                title = f"{name}, {basis}, EnergyPlus' {which}"
                compare(f"{title}: incident", incident, whole_in, lit)
                compare(f"{title}", AREA * transmitted, reference[3], lit)
                # Transmittances with the radiation that EnergyPlus has on the window
                sunny = (beam_in > 20) & (beam.sum(axis=0) > 0)
                share = optics.transmittance @ beam / np.maximum(beam.sum(axis=0), 1e-9)
                compare(
                    f"{title}: beam, same radiation",
                    AREA * share * beam_in,
                    reference[2],
                    sunny,
                )
                rest = flux - beam
                diffuse = optics.transmittance @ rest / np.maximum(rest.sum(0), 1e-9)
                same = AREA * (share * beam_in + diffuse * (whole_in - beam_in))
                compare(f"{title}: all, same radiation", same, reference[3], lit)


if __name__ == "__main__":
    main()
