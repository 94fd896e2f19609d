"""A picture of a room behind a BSDF, under sun and sky, against rpict at equal noise.

    python benchmarks/render.py [--bsdf FILE] [--resolution 800] [--write FILE]

rpict runs without interpolation of indirect light (-aa 0), where its error is noise
like ours, and with it, as pictures are made by hand. It blurs the patches of a BSDF on
purpose, so that its error on the window does not fall with more directions: the pixels
beside the window have a table of their own, which is the one that compares noise.

Seconds are those of all processors: rpict runs on one, ours on all. Ratios above 1 say
how many times less work (seconds × variance) it takes. Where errors are not noise
(interpolated, denoised) they do not fall with more work, and ratios hold for this
much of it only.
"""

import argparse
import resource
import subprocess
from pathlib import Path

import numpy as np
from duel import ENVIRONMENT, Contender, table
from rooms import Room, room, workplace
from sun_matrix import SHARED

import clerestory as cl

# Indirect light at every pixel, and between pixels.
EXACT = "-aa 0 -ad {} -as 0 -lr -10 -st 0 -ss 16"
BETWEEN = "-aa .1 -ar 256 -ad 2048 -as 512 -lr -10 -st 0 -ss 16"
SKY = "gensky 9 21 12 -a 40 -o 74 -m 75 +s"
VIEW = "-vtv -vp 3 4.5 1.5 -vd 0 -1 0 -vu 0 0 1 -vh 60 -vv 40"
BOUNCES = 4

# Target of adaptive sampling, of all pixels
TARGET = 0.03

# Around the window [m]
RIM = 0.15

NOTES = """*Seconds* are those of all processors; ours include the pilot run of each
picture, about one second at any size. *Ratios* are of work, seconds × variance. On the
window, the error of `rpict` is no noise: it blurs the patches of a BSDF on purpose, so
that more directions do not lower it. Denoised and interpolated pictures have errors
that do not fall with more work either. The blind's pane stands 5 cm before the opening
of the wall, so that the sun also shines through the gap around it, in both programs."""


def scene_files(place: Room, bsdf: Path) -> list[Path]:
    """Write window and sky, which both programs read, and return all files."""
    window = cl.read_window(place.window)
    corners = "\n".join(
        f"bsdf polygon pane{i} 0 0 {p.vertices.size} "
        + " ".join(f"{x:.9g}" for x in p.vertices.ravel())
        for i, p in enumerate(window.polygons)
    )
    (place.folder / "pane.rad").write_text(
        f"void BSDF bsdf 6 0 {bsdf} 0 0 1 . 0 0\n{corners}\n"
    )
    (place.folder / "sky.rad").write_text(
        f"!{SKY}\nskyfunc glow g 0 0 4 1 1 1 0\ng source s 0 0 4 0 0 1 180\n"
        "g source e 0 0 4 0 0 -1 180\n"
    )
    return [*place.files, place.folder / "pane.rad", place.folder / "sky.rad"]


def shows_window(place: Room, resolution: int) -> np.ndarray:
    """Return which pixels show the window or its rim."""
    view = cl.parse_view(VIEW)
    rays = view.rays(*view.size_for(resolution))
    corners = cl.read_window(place.window).polygons[0].vertices
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[1])
    along = np.sum((corners[0] - rays.origin) * normal, axis=-1)
    point = (
        rays.origin + rays.direction * (along / (rays.direction @ normal))[..., None]
    )
    low, high = corners.min(axis=0) - RIM, corners.max(axis=0) + RIM
    return np.all((point >= low) & (point <= high), axis=-1)


def contenders(place: Room, bsdf: Path, resolution: int) -> list[Contender]:
    """Return Radiance at two efforts, and ours; each makes a picture's luminance."""
    files = scene_files(place, bsdf)
    scene, view = cl.read_rad(*files), cl.parse_view(VIEW)

    def ours(samples: int, smooth: bool = False):
        name = f"{samples} paths a pixel" + (", denoised" if smooth else "")
        return Contender(
            name,
            lambda run: render(scene, view, resolution, run, smooth, samples=samples),
        )

    def theirs(name: str, options: str):
        names = " ".join(str(f) for f in files)
        command = (
            f"oconv {names} > room.oct && rpict {VIEW} -x {resolution} -y {resolution}"
            f" -ab {BOUNCES} {options} -lw 1e-5"
            " -ps 1 -pt 0 -pj .7 -dj .7 -dt 0 -dc 1 room.oct > room.hdr"
        )

        def make(_: int):
            subprocess.run(
                command, shell=True, cwd=place.folder, env=ENVIRONMENT, check=True,
                capture_output=True,
            )  # fmt: skip
            made = cl.read_picture(place.folder / "room.hdr")
            return made.luminance().astype(float)

        return Contender(name, make, peer=True)

    return [
        theirs("rpict -aa 0 -ad 64", EXACT.format(64)),
        theirs("rpict -aa 0 -ad 256", EXACT.format(256)),
        theirs("rpict -aa .1 -ad 2048", BETWEEN),
        ours(64),
        ours(256),
        Contender(
            f"adaptive, error of {TARGET:.0%}",
            lambda run: render(scene, view, resolution, run, relative_error=TARGET),
        ),
        ours(16, smooth=True),
        ours(64, smooth=True),
    ]


def render(
    scene: cl.Scene,
    view: cl.View,
    resolution: int,
    seed: int,
    smooth: bool = False,
    **effort: float,
) -> np.ndarray:
    """Return the luminance of our picture, denoised if need be."""
    columns, rows = view.size_for(resolution)
    made = cl.render(
        scene, view, columns=columns, rows=rows, bounces=BOUNCES, seed=seed, **effort
    )
    picture = cl.denoise(made.picture) if smooth else made.picture
    return picture.luminance().astype(float)


def processor_seconds() -> float:
    """Return the time of all processors in this process and those it waited for."""
    spent = (
        resource.getrusage(who)
        for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)
    )
    return sum(each.ru_utime + each.ru_stime for each in spent)


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bsdf", type=Path, help="BSDF file of the window")
    parser.add_argument("--resolution", type=int, default=800)
    parser.add_argument("--runs", type=int, default=1)
    parser.add_argument("--reference", type=int, default=1024, help="paths a pixel")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    place = room(workplace())
    bsdf = (
        options.bsdf or SHARED / "tutorial_room" / "blinds" / "blinds.xml"
    ).resolve()
    found = contenders(place, bsdf, options.resolution)
    scene, view = cl.read_rad(*scene_files(place, bsdf)), cl.parse_view(VIEW)
    # The first call of a process compiles kernels
    render(scene, view, 64, 0, samples=8)
    halves = [
        render(scene, view, options.resolution, seed, samples=options.reference // 2)
        for seed in (98765, 43210)
    ]
    window = shows_window(place, options.resolution)
    kinds = {"beside the window": ~window, "on the window": window}
    seconds: dict[str, list[float]] = {c.name: [] for c in found}
    errors = {kind: {c.name: [] for c in found} for kind in kinds}
    for run in range(1, options.runs + 1):
        for contender in found:
            start = processor_seconds()
            made = contender.make(run)
            seconds[contender.name].append(processor_seconds() - start)
            for kind, shown in kinds.items():
                error = error_against(made[shown], *(half[shown] for half in halves))
                errors[kind][contender.name].append(error)
    title = f"Picture of {options.resolution} columns, {place.name}, {bsdf.name}: "
    tables = [table(title + k, found, seconds, errors[k]) for k in kinds]
    print("\n\n".join(tables))
    if options.write:
        options.write.write_text("\n\n".join([*tables, NOTES]) + "\n")


def error_against(made: np.ndarray, one: np.ndarray, two: np.ndarray) -> float:
    """Return the root mean square error over the mean, without the reference's own.

    Parameters
    ----------
    one, two : independent references, whose mean is compared with
    """
    reference, noise = (one + two) / 2, np.mean((one - two) ** 2) / 4
    square = np.mean((made - reference) ** 2) - noise
    return float(np.sqrt(max(square, 0.0)) / reference.mean())


if __name__ == "__main__":
    main()
