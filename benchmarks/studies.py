"""A picture of each study of the gallery, and its figures: docs/studies.md.

    python benchmarks/studies.py [--only NAME]… [--samples N] [--resolution N]

Each study is run as it stands, by `clerestory run`, and once more for one moment with a
camera added. Pictures go to docs/studies/, tone-mapped.
"""

import argparse
import datetime
import json
import subprocess
import sys
import tempfile
import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from duel import stamp

import clerestory as cl
from clerestory.image.display import to_srgb, write_display
from clerestory.image.human_vision import human_vision
from clerestory.phases.render import render
from clerestory.scene.sky import sky_at
from clerestory.study.results import read_results

ROOT = Path(__file__).parents[1]
STUDIES, PAGE = ROOT / "studies", ROOT / "docs" / "studies.md"
PICTURES = ROOT / "docs" / "studies"
KEPT = PICTURES / "figures.json"


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
          "Mirrors in a film above eye level throw the sun to the ceiling of a deep"
          " classroom. Five phases, two window groups."),
    Shown("microlouvre", "room.vf", "06-21T12:30",
          "A fixed microlouvre that cuts off high sun and lets one look out. Five"
          " phases."),
    Shown("skylight", "room.vf", "06-21T12:30",
          "Four opal skylights in shafts. A window group that faces down."),
    Shown("courtyard", "court.vf", "06-21T12:30",
          "A room on the ground floor of a courtyard of three storeys. Two phases,"
          " plain glass in the scene."),
    Shown("open_plan", "room.vf", "12-21T12:30",
          "Windows on two sides, roller screens by irradiance with hysteresis in the"
          " south, dimmed luminaires."),
)  # fmt: skip


def picture(shown: Shown, resolution: int, samples: int) -> None:
    """Trace the picture of a study and write it for the page."""
    folder = STUDIES / shown.name
    text = (folder / "study.toml").read_text()
    tables = tomllib.loads(text)
    if tables["method"] == "2-phase":
        seen = outdoors(folder, tables, shown, resolution, samples)
    else:
        seen = indoors(folder, text, shown, resolution, samples)
    display = to_srgb(human_vision(seen, colour_loss=False))
    write_display(display, PICTURES / f"{shown.name}.jpg")


def indoors(
    folder: Path, text: str, shown: Shown, resolution: int, samples: int
) -> cl.Picture:
    """Return the picture through the study's own windows."""
    with tempfile.TemporaryDirectory() as out:
        study = folder / "picture.toml"
        view = f'\n[[view]]\nfile = "{shown.view}"\nresolution = {resolution}\n'
        view += f"samples = {samples}\n"
        view += f'pictures = ["{shown.moment}"]\n'
        only = f'[weather]\nmoments = ["{shown.moment}"]\n'
        quick = text.replace("relative_error = 0.02", "samples = 512")
        study.write_text(quick.replace("[weather]\n", only) + view)
        try:
            run(study, Path(out))
        finally:
            study.unlink()
        (file,) = Path(out, "pictures").glob("*.hdr")
        return cl.read_picture(file)


def outdoors(
    folder: Path, tables: dict[str, Any], shown: Shown, resolution: int, samples: int
) -> cl.Picture:
    """Return a picture of the scene as it stands, under the sky of the moment."""
    files = [folder / name for name in tables["scene"]["files"]]
    weather = cl.read_weather(folder / tables["weather"]["file"])
    year = int(str(weather.times[0])[:4])
    moment = datetime.datetime.fromisoformat(f"{year}-{shown.moment}")
    scene = cl.read_rad(*files) + sky_at(weather, moment)
    view = cl.read_view(folder / shown.view)
    columns, rows = view.size_for(resolution)
    made = render(scene, view, columns=columns, rows=rows, samples=samples, seed=1)
    return made.picture


def run(study: Path, out: Path) -> None:
    """Run a study by the command line."""
    words = ["-c", "import sys; from clerestory.cli.main import main; sys.exit(main())"]
    command = [sys.executable, *words, "run", str(study), "--quiet", "--out", str(out)]
    subprocess.run(command, check=True)


def figures(shown: Shown, folder: Path | None) -> dict[str, Any]:
    """Return what the page says of a study, run now or found in a folder of runs."""
    with tempfile.TemporaryDirectory() as name:
        out = Path(name) if folder is None else folder / shown.name
        if folder is None:
            run(STUDIES / shown.name / "study.toml", out)
        data = read_results(out).data
    return {
        "sensors": int(data.sizes["sensor"]),
        "mean": float(data["mean_illuminance"].mean()),
        "autonomy": float(data["daylight_autonomy"].mean()),
        "useful": float(data["useful"].mean()),
    }


def page(found: dict[str, dict[str, Any]]) -> str:
    """Return the page of the gallery."""
    lines = [
        "# A gallery of studies",
        "",
        "Six rooms in `studies/`, each run by one command. Geometry, BSDFs and weather",
        "are our own or in the public domain; `studies/make.py` makes the BSDFs from",
        "parametric systems and the weather (Greensboro, TMY3) from pvlib's data. Take",
        "one as the start of your own. A seventh,",
        "`studies/crash_course_day`, is a day as a film.",
        "",
        f"Figures and pictures by `benchmarks/studies.py`, {stamp()}.",
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
            lines += [
                f"{one['sensors']} sensors: mean {one['mean']:.0f} lux, daylight"
                f" autonomy {100 * one['autonomy']:.0f} %, useful illuminance in"
                f" {100 * one['useful']:.0f} % of the hours from 8 to 18.",
                "",
            ]
    return "\n".join(lines).rstrip() + "\n"


def main() -> None:
    """Run the studies asked for and write the page of all that were ever run."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", action="append", default=[])
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--resolution", type=int, default=480)
    parser.add_argument("--results", type=Path, help="folder of finished runs, by name")
    parser.add_argument("--skip-pictures", action="store_true")
    words = parser.parse_args()
    PICTURES.mkdir(exist_ok=True)
    found = json.loads(KEPT.read_text()) if KEPT.is_file() else {}
    for shown in SHOWN:
        if words.only and shown.name not in words.only:
            continue
        if not words.skip_pictures:
            picture(shown, words.resolution, words.samples)
        found[shown.name] = figures(shown, words.results)
        KEPT.write_text(json.dumps(found, indent=1) + "\n")
    PAGE.write_text(page(found))


if __name__ == "__main__":
    main()
