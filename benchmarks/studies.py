"""A picture of each study of the gallery, and its figures: docs/studies.md.

    python benchmarks/studies.py [--only NAME]… [--samples N] [--resolution N]
        [--results DIR]

Each study is run as it stands, by `clerestory run`. Its picture is traced at one moment
with the BSDFs of the states that the run chose, smoothed for the eye by Open Image
Denoise, and written to docs/studies/.
"""

import argparse
import datetime
import json
import resource
import subprocess
import sys
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.bands import RGB
from clerestory.image.denoise import denoise
from clerestory.image.srgb_display import to_srgb, write_display
from clerestory.image.tone_curves import filmic, key_luminance
from clerestory.metrics.replicates import error_of_group_mean
from clerestory.phases.rendering import render
from clerestory.radiance.generated_sky import sky_at
from clerestory.report.uncertain_value import Figure
from clerestory.scene.band_conversion import in_bands
from clerestory.scene.model import BsdfSurface
from clerestory.scene.surface import Polygon
from clerestory.study.config import read_study
from clerestory.study.inputs import Inputs, read_inputs
from clerestory.study.results import Results, read_results

ROOT = Path(__file__).parents[1]
STUDIES, PAGE = ROOT / "studies", ROOT / "docs" / "studies.md"
PICTURES = ROOT / "docs" / "studies"
KEPT = PICTURES / "figures.json"

# White of the pictures, as a share of what suits a photograph: rooms of light walls
BRIGHTER = 0.5


@dataclass(frozen=True)
class Shown:
    """A study of the gallery.

    Attributes
    ----------
    name : of its folder
    view : its camera's file
    moment : shown in its picture
    words : what it is about
    """

    name: str
    view: str
    moment: str
    words: str


SHOWN = (
    Shown("office_blinds", "room.vf", "09-21T12:30",
          "An outer venetian blind follows the sun in four states, luminaires dim."
          " Geometry of the slats as BSDFs, a control rule, lighting energy."),
    Shown("redirecting_film", "room.vf", "09-21T12:30",
          "Mirrors in a film above eye level reflect the sun to the ceiling of a deep"
          " classroom. Five phases, two window groups."),
    Shown("microlouvre", "room.vf", "06-21T12:30",
          "A fixed microlouvre that cuts off high sun and keeps the view out. Five"
          " phases."),
    Shown("skylight", "room.vf", "06-21T12:30",
          "Four opal skylights in shafts. A window group that faces down."),
    Shown("courtyard", "court.vf", "06-21T12:30",
          "A room on the ground floor of a courtyard of three storeys. Two phases,"
          " plain glass in the scene."),
    Shown("open_plan", "room.vf", "12-21T12:30",
          "Windows on two sides, roller screens by irradiance with hysteresis in the"
          " south, dimmed luminaires."),
    Shown("melanopic_classroom", "../redirecting_film/room.vf", "09-21T12:30",
          "Melanopic light at four eyes behind a blind, with a film of mirrors above:"
          " twenty bands, coloured walls and floor, tinted glass, spectra of sky and"
          " sun. The blind gives four bright hours by noon."),
)  # fmt: skip


def picture(shown: Shown, results: Results, resolution: int, samples: int) -> None:
    """Trace the picture of a study at its moment and write it for the page."""
    study = read_study(STUDIES / shown.name / "study.toml")
    inputs = read_inputs(study)
    year = int(str(inputs.weather.times[0])[:4])
    moment = datetime.datetime.fromisoformat(f"{year}-{shown.moment}")
    scene, bands = inputs.scene, inputs.scene.bands
    scene += panes(inputs, results, np.datetime64(moment))
    light = sky_at(inputs.weather, moment)
    if bands != RGB:
        light = in_bands(light, bands)  # white
    view = cl.read_view(study.folder / shown.view)
    columns, rows = view.size_for(resolution)
    made = render(
        scene + light,
        view,
        columns=columns,
        rows=rows,
        samples=samples,
        seed=1,
    )
    smooth = denoise(made.picture)
    display = to_srgb(filmic(smooth, white=BRIGHTER * key_luminance(smooth)))
    write_display(display, PICTURES / f"{shown.name}.jpg")


def panes(inputs: Inputs, results: Results, moment: np.datetime64) -> cl.Scene:
    """Return the windows as surfaces with the BSDFs of the states of a moment."""
    materials: dict[str, BsdfSurface] = {}
    surfaces: list[Polygon] = []
    for number, group in enumerate(inputs.groups):
        state = 0
        if "state" in results.data:
            state = int(results.data["state"][number].sel(time=moment))
        frame = group.inner.frame
        materials[group.name] = BsdfSurface(
            group.name, group.states[state].fine, 0.0, frame.up, peak=True
        )
        surfaces += [
            replace(pane, material=group.name) for pane in group.inner.polygons
        ]
    return cl.Scene(materials, tuple(surfaces), bands=inputs.scene.bands)


def run(study: Path, out: Path) -> None:
    """Run a study by the command line."""
    words = ["-c", "import sys; from clerestory.cli.main import main; sys.exit(main())"]
    command = [sys.executable, *words, "run", str(study), "--quiet", "--out", str(out)]
    subprocess.run(command, check=True)


def finished(shown: Shown, folder: Path) -> tuple[Results, float | None]:
    """Return the results of a study, run now if they are not in a folder of runs.

    The second value is the processor time of a run made now [s].

    Raises
    ------
    subprocess.CalledProcessError : the run failed
    """
    out = folder / shown.name
    if (out / "results.nc").is_file():
        return read_results(out), None
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    run(STUDIES / shown.name / "study.toml", out)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    took = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return read_results(out), took


def figures(results: Results, processor: float | None) -> dict[str, Any]:
    """Return what the page says of a study."""
    data = results.data
    return {
        "sensors": int(data.sizes["sensor"]),
        "mean": float(data["mean_illuminance"].mean()),
        "error": error_of_group_mean(data["mean_illuminance_components"].values),
        "autonomy": float(data["daylight_autonomy"].mean()),
        "autonomy_error": error_of_group_mean(
            data["daylight_autonomy_components"].values
        ),
        "useful": float(data["useful"].mean()),
        "hourly": float(
            next(iter(results.run["median_relative_error_of_mean"].values()))
        ),
        "processor": processor,
        "sun": float(data["room_hours_of_sun"])
        if "room_hours_of_sun" in data
        else None,
        **{
            name: float(data[name].mean()) if name in data else None
            for name in ("mean_melanopic_edi", "melanopic_autonomy", "melanopic_days")
        },
    }


def page(found: dict[str, dict[str, Any]]) -> str:
    """Return the page of the gallery."""
    lines = [
        "# A gallery of studies",
        "",
        "Seven rooms in `studies/`, each run by one command. Geometry, BSDFs and",
        "weather are our own or public domain; `studies/make.py` makes the BSDFs from",
        "parametric systems and the weather (Greensboro, TMY3) from pvlib's data. Each",
        "can be copied and adapted to another room. Two more studies are not shown",
        "here: `studies/crash_course_day` is an animation of one day, and",
        "`studies/office_standards` assesses the office with blinds by LM-83, LEED,",
        "EN 17037 and BREEAM, with glare at two seats and a title block.",
        "",
        f"Figures and pictures by `benchmarks/studies.py`, {stamp()}.",
        "± is one standard error, the run's own.",
        "",
    ]
    for shown in SHOWN:
        lines += [
            f"## {shown.name.replace('_', ' ').capitalize()}",
            "",
            "```sh",
            f"clerestory run studies/{shown.name}/study.toml",
            "```",
            "",
            shown.words,
            "",
        ]
        if (PICTURES / f"{shown.name}.jpg").is_file():
            title = shown.words.split(".")[0]
            lines += [f"![{title}](studies/{shown.name}.jpg)", ""]
        one = found.get(shown.name)
        if one is not None:
            lines += [*words_of(one), ""]
    return "\n".join(lines).rstrip() + "\n"


def words_of(one: dict[str, Any]) -> list[str]:
    """Return the figures of a study in sentences."""
    mean = Figure(one["mean"], one["error"], "lux")
    autonomy = Figure(100 * one["autonomy"], 100 * one["autonomy_error"], "%")
    lines = [
        f"{one['sensors']} sensors: {mean} on average, daylight autonomy {autonomy},"
        " useful illuminance in"
        f" {100 * one['useful']:.0f} % of the hours from 8 to 18.",
    ]
    if one["sun"] is not None:
        lines.append(f"EN 17037: {one['sun']:.1f} h of sun on 21 March.")
    if one.get("mean_melanopic_edi") is not None:
        lines.append(
            f"Melanopic EDI: {one['mean_melanopic_edi']:,.0f} lux on average, 250 lux"
            f" in {100 * one['melanopic_autonomy']:.0f} % of the hours, and for four"
            f" hours by noon on {100 * one['melanopic_days']:.0f} % of the days."
        )
    if one["processor"] is not None:
        lines.append(f"The run took {one['processor']:.0f} s of processor time.")
    return lines


def main() -> None:
    """Run the studies asked for and write the page of all that were ever run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--resolution", type=int, default=640)
    parser.add_argument("--results", type=Path, help="folder that keeps the runs")
    parser.add_argument("--skip-pictures", action="store_true")
    words = parser.parse_args()
    PICTURES.mkdir(exist_ok=True)
    found = json.loads(KEPT.read_text()) if KEPT.is_file() else {}
    with tempfile.TemporaryDirectory() as scratch:
        folder = words.results or Path(scratch)
        for shown in SHOWN:
            if words.only and shown.name not in words.only:
                continue
            results, took = finished(shown, folder)
            if not words.skip_pictures:
                picture(shown, results, words.resolution, words.samples)
            if took is None:
                took = found.get(shown.name, {}).get("processor")
            found[shown.name] = figures(results, took)
            KEPT.write_text(json.dumps(found, indent=1) + "\n")
    PAGE.write_text(page(found))


if __name__ == "__main__":
    main()
