"""Direct-sun matrices of sensors against rcontrib at equal error.

    python benchmarks/sun_matrix.py [--sensors 25] [--runs 3] [--write FILE]

Both trace the 5185 suns of Reinhart's MF 6 through a window with a BSDF in a black
room, as the five-phase tutorial does. Ratios above 1 say how many times less work
(time × variance) it takes.
"""

import argparse
from pathlib import Path

import numpy as np
from duel import Contender, devices, duel, on, radiance
from rooms import Room, room, workplace

import clerestory as cl
from clerestory.phases.sun_coefficients import sun_coefficients

SHARED = Path(__file__).parents[2] / "shared" / "data"
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))

# As the tutorial of the five-phase method has it, with its 256 directions; but asked
# for contributions (-V+): rcontrib 6.0a loses most coefficients of suns behind BSDFs
SUN_RADIANCE = 1e6
RCONTRIB = (
    "rcontrib -n 2 -h -w- -V+ -I+ -ab 1 -ad {directions} -lw 1e-3 -dc 1 -dt 0 -dj 0"
    " -e MF:6 -f reinhart.cal -b rbin -bn Nrbins -m solar suns.oct"
)


def write_suns(place: Room, bsdf: Path, directions: np.ndarray) -> None:
    """Write the black room with the BSDF in its window under all suns."""
    window = cl.read_window(place.window)
    corners = "\n".join(
        f"bsdf polygon pane{i} 0 0 {p.vertices.size} "
        + " ".join(f"{x:.9g}" for x in p.vertices.ravel())
        for i, p in enumerate(window.polygons)
    )
    suns = "\n".join(
        f"solar source s{i} 0 0 4 {x:.9g} {y:.9g} {z:.9g} 0.533"
        for i, (x, y, z) in enumerate(directions)
    )
    text = f"void BSDF bsdf 6 0 {bsdf} 0 0 1 . 0 0\n{corners}\n"
    text += f"void light solar 0 0 3 1e6 1e6 1e6\n{suns}\n"
    (place.folder / "suns.rad").write_text(text)
    (place.folder / "black.rad").write_text("void plastic black 0 0 5 0 0 0 0 0\n")
    files = " ".join(str(f) for f in place.files)
    radiance(
        f"xform -m black {files} > room_black.rad &&"
        " oconv black.rad room_black.rad suns.rad > suns.oct && echo 0 0 0",
        place.folder,
    )


def contenders(
    place: Room, bsdf: Path, count: int
) -> tuple[list[Contender], np.ndarray]:
    """Return our runs at two efforts, Radiance's, and a long reference."""
    scene, window = place.scene(), cl.read_window(place.window)
    sensors = cl.read_sensors(place.points)
    # Beside its window the tutorial's room has a gap that low sun shines through onto
    # the first row of sensors: rcontrib sees it, a window's own matrix does not
    sill = window.polygons[0].vertices[0]
    inner = (sensors.position - sill) @ window.frame.normal > 1
    step = max(1, int(inner.sum()) // count)
    chosen = type(sensors)(
        sensors.position[inner][::step], sensors.direction[inner][::step]
    )
    text = "\n".join(
        " ".join(f"{x:.9g}" for x in (*p, *d))
        for p, d in zip(chosen.position, chosen.direction, strict=True)
    )
    directions = cl.reinhart(6).dome.centres()
    front = directions @ window.frame.normal < 0
    write_suns(place, bsdf, directions)
    layer = cl.read_bsdf(bsdf)

    def ours(samples: int, device: str):
        def make(run: int):
            matrix = sun_coefficients(
                scene, [window], window.name, layer, sensors=chosen,
                suns=directions[front], samples=samples, seed=run, device=device,
            )  # fmt: skip
            return matrix.values[0]

        return Contender(f"{samples} paths a sensor{on(device)}", make)

    def theirs(name: str, directions: int):
        command = RCONTRIB.format(directions=directions)

        def make(_: int):
            found = radiance(command, place.folder, text)
            return found[:, 1:][:, front] / SUN_SR / SUN_RADIANCE

        return Contender(f"rcontrib {name}", make, peer=True)

    found = [theirs("as the tutorial (-ad 256)", 256), theirs("-ad 2000", 2000)]
    found += [ours(n, d) for d in devices() for n in (256, 1024)]
    return found, ours(1 << 17, devices()[-1]).make(12345)


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--bsdf", type=Path, help="BSDF file of the window")
    parser.add_argument("--sensors", type=int, default=25)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    place = room(workplace())
    bsdf = options.bsdf or SHARED / "tutorial_room" / "blinds" / "blinds.xml"
    found, reference = contenders(place, bsdf.resolve(), options.sensors)
    title = f"Direct suns, {place.name}, {bsdf.name}, {options.sensors} sensors"
    table = duel(title, found, reference, runs=options.runs)
    print(table)
    if options.write:
        options.write.write_text(table + "\n")


if __name__ == "__main__":
    main()
