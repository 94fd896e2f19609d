"""Pictures: speed beside Radiance's, agreement with pcond, figures of the docs.

python benchmarks/pictures.py [--figures] [--write]
"""

import argparse
import datetime
import importlib.metadata
import os
import platform
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from duel import ENVIRONMENT
from gallery import ROOM_VIEW, SCENES, SEPTEMBER
from PIL import Image

import clerestory as cl
from clerestory.image.colour_scale import linear_scale, logarithmic_scale
from clerestory.image.false_colour import false_colour
from clerestory.image.srgb_display import to_srgb
from clerestory.image.tone_curves import filmic, linear
from clerestory.image.visibility_matching import human_vision
from clerestory.phases.rendering import render
from clerestory.radiance.generated_sky import sky_scene
from clerestory.scene.view import solid_angles

DOCS = Path(__file__).parents[1] / "docs"
SIDE = 800


def noisy(side: int) -> cl.Picture:
    """Return a picture with detail of many sizes: hard to encode."""
    rng = np.random.default_rng(1)
    y, x = np.mgrid[:side, :side] / side
    smooth = np.exp(3 * np.sin(5 * x) * np.cos(7 * y))
    values = smooth[..., None] * rng.uniform(0.9, 1.1, (side, side, 3))
    values[: side // 4] = 0.5
    view = cl.parse_view("-vta -vp 0 0 1.2 -vd 0 1 0 -vh 180 -vv 180")
    return cl.Picture(values.astype(np.float32), view=view)


def best(work: Callable[[], object], runs: int = 5) -> float:
    """Return the shortest of several times [ms]."""
    times = []
    for _ in range(runs):
        begin = time.perf_counter()
        work()
        times.append(time.perf_counter() - begin)
    return 1000 * min(times)


def command(text: str, folder: Path) -> Callable[[], object]:
    """Return a call of one of Radiance's programs."""
    return lambda: subprocess.run(
        text, shell=True, cwd=folder, env=ENVIRONMENT, check=True, capture_output=True
    )


def table(folder: Path) -> list[str]:
    """Measure, and return the rows of the table."""
    picture = noisy(SIDE)
    path = folder / "a.hdr"
    cl.write_picture(picture, path)
    read = cl.read_picture(path)
    cl.write_picture(picture, folder / "a.exr")
    ours = {
        "read RGBE": lambda: cl.read_picture(path),
        "write RGBE": lambda: cl.write_picture(picture, folder / "b.hdr"),
        "read EXR, 32 bits": lambda: cl.read_picture(folder / "a.exr"),
        "rays of a view": lambda: picture.view.rays(SIDE, SIDE),
        "solid angles": lambda: solid_angles(picture.view, SIDE, SIDE),
        "tone mapping, human": lambda: human_vision(read),
    }
    theirs = {
        "read RGBE": "pvalue -o -h -H -df a.hdr > values",
        "rays of a view": "vwrays -ff a.hdr > rays",
        "tone mapping, human": "pcond -s -c a.hdr > c.hdr",
    }
    rows = ["| job | Clerestory | Radiance |", "|---|---|---|"]
    for name, work in ours.items():
        peer = theirs.get(name)
        other = (
            f"{best(command(peer, folder)):.0f} ms (`{peer.split()[0]}`)"
            if peer
            else "–"
        )
        rows.append(f"| {name} | {best(work):.0f} ms | {other} |")
    return rows


def agreement(folder: Path) -> str:
    """Return how far display values lie from those of pcond."""
    read = cl.read_picture(folder / "a.hdr")
    command("pcond -s -c a.hdr > c.hdr", folder)()
    theirs = cl.read_picture(folder / "c.hdr")
    text = (folder / "c.hdr").read_bytes().partition(b"\n\n")[0].decode()
    told = [line for line in text.split("\n") if line.startswith("EXPOSURE")]
    exposure = float(told[-1].partition("=")[2]) if told else 1.0
    difference = human_vision(read) - exposure * theirs.radiance
    rms = float(np.sqrt(np.mean(difference**2)))
    return (
        f"Display values (0 black, 1 white) differ from `pcond -s -c` by {rms:.4f} root"
        " mean square; 8-bit mantissas alone make 0.001."
    )


def figures(samples: int) -> None:
    """Render the room of the gallery and write the figures of docs/pictures.md."""
    room = cl.read_rad(SCENES / "room.rad", SCENES / "ground.rad")
    scene = room + sky_scene(SEPTEMBER)
    view = cl.parse_view(ROOM_VIEW)
    columns, rows = view.size_for(300)
    made = render(scene, view, columns=columns, rows=rows, samples=samples, seed=1)
    picture = made.picture
    mapped = [human_vision(picture), filmic(picture), linear(picture)]
    beside(DOCS / "pictures" / "tone.jpg", [to_srgb(x) for x in mapped])
    drawn = [
        false_colour(picture, linear_scale(picture, largest=5000)),
        false_colour(picture, logarithmic_scale(picture, decades=3), extremes=True),
        false_colour(
            picture, linear_scale(picture, largest=5000, divisions=5), style="lines"
        ),
    ]
    beside(DOCS / "pictures" / "false-colour.jpg", drawn)


def beside(path: Path, pictures: list[np.ndarray]) -> None:
    """Write pictures side by side."""
    path.parent.mkdir(exist_ok=True)
    height = max(len(picture) for picture in pictures)
    width = sum(picture.shape[1] for picture in pictures) + 6 * (len(pictures) - 1)
    sheet = Image.new("RGB", (width, height), "white")
    left = 0
    for picture in pictures:
        sheet.paste(Image.fromarray(picture), (left, 0))
        left += picture.shape[1] + 6
    sheet.save(path, quality=78, optimize=True)


def main() -> None:
    """Read the command line, measure, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--figures", action="store_true")
    parser.add_argument("--samples", type=int, default=512)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    if options.figures:
        figures(options.samples)
    with tempfile.TemporaryDirectory() as name:
        rows = table(Path(name))
        sentence = agreement(Path(name))
    version = importlib.metadata.version("clerestory")
    today = datetime.datetime.now(tz=datetime.UTC).date()
    text = "\n".join(
        [
            "# Pictures: speed and agreement",
            "",
            f"A picture of {SIDE} × {SIDE} pixels, the shortest of five runs on"
            f" {len(os.sched_getaffinity(0))} cores of {platform.machine()}, {today},"
            f" Clerestory {version}, Radiance of pyradiance"
            f" {importlib.metadata.version('pyradiance')}. Radiance's times include"
            " starting the program and reading the picture. Made by"
            " `benchmarks/pictures.py`.",
            "",
            *rows,
            "",
            sentence,
            "",
        ]
    )
    print(text)
    if options.write:
        (DOCS / "benchmarks" / "pictures.md").write_text(text)


if __name__ == "__main__":
    main()
