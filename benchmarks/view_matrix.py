"""View matrices against rfluxmtx at equal error.

    python benchmarks/view_matrix.py [--triangles 240000] [--runs 5] [--write FILE]

Ratios above 1 say how many times less work (time × variance) it takes.
"""

import argparse
from pathlib import Path

from duel import Contender, devices, duel, on, radiance
from rooms import Room, finely_cut, room, workplace

import clerestory as cl

# Radiance's -ab, for both programs
BOUNCES = 4


def contenders(place: Room, *, tuned: bool) -> tuple[list[Contender], "object"]:
    """Return our runs at three efforts, Radiance's, and a long reference."""
    scene, window = place.scene(), cl.read_window(place.window)
    sensors, text = cl.read_sensors(place.points), place.points.read_text()
    files = " ".join(str(f) for f in place.files)
    radiance(f"oconv {files} > view.oct && echo 0 0 0", place.folder)

    def ours(samples: int, device: str):
        def make(run: int):
            matrix = cl.view_matrix(
                scene,
                window,
                sensors=sensors,
                samples=samples,
                bounces=BOUNCES,
                seed=run,
                device=device,
            )
            return matrix.values[0]

        return Contender(f"{samples:,} paths a sensor{on(device)}", make)

    def theirs(name: str, options: str):
        command = (
            f"rfluxmtx -n 2 -h -I+ -ab {BOUNCES} {options} -y {len(sensors.position)}"
            f" - {place.window} -i view.oct"
        )
        return Contender(
            f"rfluxmtx {name}",
            lambda _: radiance(command, place.folder, text),
            peer=True,
        )

    found = [theirs("as the tutorial (-ad 5000 -lw 2e-4)", "-ad 5000 -lw 2e-4")]
    if tuned:
        found.append(theirs("tuned (-ad 20000 -lw 1e-5)", "-ad 20000 -lw 1e-5"))
    found += [ours(n, d) for d in devices() for n in (1 << 12, 1 << 14, 1 << 16)]
    return found, ours(1 << 20, devices()[-1]).make(12345)


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--triangles", type=int, help="cut the room this fine")
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--tuned", action="store_true", help="the slow settings too")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    place = room(workplace())
    if options.triangles:
        place = finely_cut(place, options.triangles)
    found, reference = contenders(place, tuned=options.tuned)
    table = duel(f"View matrix, {place.name}", found, reference, runs=options.runs)
    print(table)
    if options.write:
        options.write.write_text(table + "\n")


if __name__ == "__main__":
    main()
