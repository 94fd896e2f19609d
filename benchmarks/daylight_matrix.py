"""Daylight matrices against rfluxmtx at equal error.

    python benchmarks/daylight_matrix.py [--triangles 240000] [--runs 3] [--write FILE]

Ratios above 1 say how many times less work (time × variance) it takes.
"""

import argparse
from pathlib import Path

from duel import Contender, devices, duel, on, radiance
from rooms import Room, finely_cut, room, workplace

import clerestory as cl

# Radiance's -ab, for both programs
BOUNCES = 4

SKY = """#@rfluxmtx h=u u=Y
void glow below 0 0 4 1 1 1 0
below source ground_half 0 0 4 0 0 -1 180
#@rfluxmtx h=r1 u=Y
void glow above 0 0 4 1 1 1 0
above source sky_half 0 0 4 0 0 1 180
"""


def contenders(place: Room, *, slow: bool) -> tuple[list[Contender], "object"]:
    """Return our runs at three efforts, Radiance's, and a long reference."""
    scene, window = place.scene(), cl.read_window(place.window)
    files = " ".join(str(f) for f in place.files)
    (place.folder / "sky_and_ground.rad").write_text(SKY)
    radiance(f"oconv {files} > daylight.oct && echo 0 0 0", place.folder)

    def ours(samples: int, device: str):
        def make(run: int):
            matrix = cl.daylight_matrix(
                scene,
                window,
                subdivision=1,
                samples=samples,
                bounces=BOUNCES,
                seed=run,
                device=device,
            )
            return matrix.values[0]

        return Contender(f"{samples:,} paths a patch{on(device)}", make)

    def theirs(name: str, options: str):
        command = (
            f"rfluxmtx -n 2 -h -ab {BOUNCES} {options} {place.window}"
            " sky_and_ground.rad -i daylight.oct"
        )
        make = lambda _: radiance(command, place.folder)  # noqa: E731 - a closure a line
        return Contender(f"rfluxmtx {name}", make, peer=True)

    tuned = "-ad 1 -lw 1e-6 -c 10000"
    recipe = "-c 1000 -ad 1000 -lw 1e-3"
    found = [theirs(f"tuned ({tuned})", tuned)]
    if slow:
        found.append(theirs(f"as the tutorial ({recipe})", recipe))
    found += [ours(n, d) for d in devices() for n in (1 << 12, 1 << 14, 1 << 16)]
    return found, ours(1 << 20, devices()[-1]).make(12345)


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--triangles", type=int, help="cut the room this fine")
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--tutorial", action="store_true", help="the slow recipe too")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    place = room(workplace())
    if options.triangles:
        place = finely_cut(place, options.triangles)
    found, reference = contenders(place, slow=options.tutorial)
    table = duel(f"Daylight matrix, {place.name}", found, reference, runs=options.runs)
    print(table)
    if options.write:
        options.write.write_text(table + "\n")


if __name__ == "__main__":
    main()
