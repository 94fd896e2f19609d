"""Cost of a path in a room: plain, in the sun, and behind a BSDF.

    python benchmarks/path_cost.py [--resolution 96] [--write FILE]

The room and the view are those of `render.py`. The cost is the difference of the
processor times of 256 and of 64 paths a pixel, over the number of paths: neither
compilation nor preparation counts. Mitsuba's own integrator `path` traces the room with
an open window below a uniform sky, to the same depth, in turns with ours.
"""

import argparse
from collections.abc import Callable
from pathlib import Path

import numpy as np
from duel import stamp
from render import BOUNCES, VIEW, processor_seconds, scene_files
from rooms import room, workplace
from sun_matrix import SHARED

import clerestory as cl
from clerestory.engine.device import load
from clerestory.scene.tessellate import meshes

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


def mitsuba_path(scene: cl.Scene, resolution: int) -> Callable[[], float]:
    """Return a function that measures Mitsuba's `path` [paths per processor second].

    The room has the same triangles and reflectances, in Mitsuba's own `diffuse`.
    """
    load()
    import mitsuba as mi  # noqa: PLC0415 - only after `load` has found LLVM

    content = {
        "type": "scene",
        "integrator": {"type": "path", "max_depth": BOUNCES + 2, "rr_depth": 100},
        "sky": {"type": "constant"},
    }
    for number, mesh in enumerate(meshes(scene)):
        made = mi.Mesh(str(number), len(mesh.vertices), len(mesh.faces))
        values = mi.traverse(made)
        values["vertex_positions"] = mesh.vertices.astype(np.float32).ravel()
        values["faces"] = mesh.faces.astype(np.uint32).ravel()
        values.update()
        file = str(workplace() / f"{number}.ply")
        made.write_ply(file)
        colour = {"type": "rgb", "value": [*map(float, mesh.material.reflectance)]}
        matt = {"type": "twosided", "one": {"type": "diffuse", "reflectance": colour}}
        shape = {"type": "ply", "filename": file, "face_normals": True, "matt": matt}
        content[f"mesh{number}"] = shape
    view = cl.parse_view(VIEW)
    columns, rows = view.size_for(resolution)
    to = view.position + view.direction
    turned = mi.ScalarTransform4f().look_at([*view.position], [*to], [*view.up])
    film = {"type": "hdrfilm", "width": columns, "height": rows}
    content["camera"] = {
        "type": "perspective",
        "fov": 60,
        "to_world": turned,
        "film": {**film, "rfilter": {"type": "box"}},
    }
    room = mi.load_dict(content)

    def rate() -> float:
        spent = []
        for samples in (8, FEW, MANY):
            start = processor_seconds()
            np.array(mi.render(room, spp=samples))
            spent.append(processor_seconds() - start)
        return (MANY - FEW) * columns * rows / (spent[2] - spent[1])

    return rate


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--resolution", type=int, default=96)
    parser.add_argument("--runs", type=int, default=3, help="of which the median")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    lines = [
        f"### Cost of a path, tutorial room, {BOUNCES} bounces",
        "",
        f"{stamp()}. Made by `benchmarks/path_cost.py`: {options.resolution} columns, "
        f"medians of {options.runs} runs in turns.",
        "",
        f"| | paths per processor second | error of a pixel at {MANY} paths |",
        "|---|---|---|",
    ]
    measured = scenes()
    theirs = mitsuba_path(measured["open window, sky"], options.resolution)
    turns = [
        (theirs(), *(cost(scene, options.resolution) for scene in measured.values()))
        for _ in range(options.runs)
    ]
    rates = np.median([[t[0], *(rate for rate, _ in t[1:])] for t in turns], axis=0)
    errors = ["–", *(f"{error:.1%}" for _, error in turns[0][1:])]
    names = ["open window, uniform sky: Mitsuba's `path`", *measured]
    for name, rate, error in zip(names, rates, errors, strict=True):
        lines.append(f"| {name} | {rate:,.0f} | {error} |")
    print("\n".join(lines))
    if options.write:
        options.write.write_text("\n".join(lines) + "\n")


if __name__ == "__main__":
    main()
