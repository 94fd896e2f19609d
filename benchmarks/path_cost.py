"""Cost of a path in a room: plain, in the sun, and behind a BSDF.

    python benchmarks/path_cost.py [--resolution 96] [--write FILE]

The room and the view are those of `render.py`. The cost is the difference of the
processor times of 256 and of 64 paths a pixel, over the number of paths: neither
compilation nor preparation counts.
"""

import argparse
from pathlib import Path

import numpy as np
from duel import stamp
from render import BOUNCES, VIEW, processor_seconds, scene_files
from rooms import room, workplace
from sun_matrix import SHARED

import clerestory as cl

FEW, MANY = 64, 256


def scenes() -> dict[str, cl.Scene]:
    """Return the room with an open window and behind a BSDF, with and without sun."""
    place = room(workplace())
    files = scene_files(place, SHARED / "tutorial_room" / "blinds" / "blinds.xml")
    bright = (place.folder / "sky.rad").read_text()
    dull = place.folder / "dull.rad"
    dull.write_text(bright.replace("+s", "-s"))
    bare = [file for file in files[:-1] if file.name != "pane.rad"]
    return {
        "open window, sky": cl.read_rad(*bare, dull),
        "open window, sky and sun": cl.read_rad(*bare, files[-1]),
        "window with a BSDF, sky": cl.read_rad(*files[:-1], dull),
        "window with a BSDF, sky and sun": cl.read_rad(*files),
    }


def cost(scene: cl.Scene, resolution: int) -> tuple[float, float]:
    """Return paths per processor second, and the error of a pixel over the mean."""
    view = cl.parse_view(VIEW)
    columns, rows = view.size_for(resolution)
    spent = []
    for samples in (8, FEW, MANY):
        start = processor_seconds()
        made = cl.render(
            scene, view, columns=columns, rows=rows, samples=samples, bounces=BOUNCES
        )
        spent.append(processor_seconds() - start)
    error = np.sqrt(np.mean(made.error**2)) / made.picture.radiance.mean()
    return (MANY - FEW) * columns * rows / (spent[2] - spent[1]), float(error)


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--resolution", type=int, default=96)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    lines = [
        f"### Cost of a path, tutorial room, {BOUNCES} bounces",
        "",
        f"{stamp()}. Made by `benchmarks/path_cost.py`: {options.resolution} columns.",
        "",
        f"| | paths per processor second | error of a pixel at {MANY} paths |",
        "|---|---|---|",
    ]
    for name, scene in scenes().items():
        rate, error = cost(scene, options.resolution)
        lines.append(f"| {name} | {rate:,.0f} | {error:.1%} |")
        print(lines[-1], flush=True)
    if options.write:
        options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
