"""Do view matrices lose light? Row sums against rfluxmtx under several settings.

    python benchmarks/row_sums.py [--write FILE]

The sum of a row is the irradiance under a window of uniform radiance. Ours is
unlimited in samples here; Radiance's settings differ in where rays are dropped.
"""

import argparse
from pathlib import Path

import numpy as np
from duel import radiance, stamp
from rooms import room, workplace

import clerestory as cl

SETTINGS = (
    "-ab 4 -ad 5000 -lw 2e-4",
    "-ab 4 -ad 20000 -lw 1e-5",
    "-ab 4 -ad 500 -lw 2e-3",
    "-ab 4 -ad 5000 -lw 2e-4 -lr 8",
    "-ab 4 -ad 5000 -lw 2e-5 -lr 8",
    "-ab 8 -ad 5000 -lw 2e-4",
)


def table() -> str:
    """Return a Markdown table of Radiance's sums relative to ours."""
    place = room(workplace())
    scene, window = place.scene(), cl.read_window(place.window)
    sensors, text = cl.read_sensors(place.points), place.points.read_text()
    files = " ".join(str(f) for f in place.files)
    radiance(f"oconv {files} > view.oct && echo 0 0 0", place.folder)
    lines = [
        f"### Row sums of the view matrix, {place.name}",
        "",
        stamp(),
        "",
        "| rfluxmtx | all rows / ours | mean row / ours | ours, standard error |",
        "|---|---|---|---|",
    ]
    ours = {}
    for settings in SETTINGS:
        bounces = int(settings.split()[1])
        if bounces not in ours:
            matrix = cl.view_matrix(
                scene,
                window,
                sensors=sensors,
                samples=1 << 17,
                bounces=bounces,
            )
            total = np.sum(matrix.components[:, 0], axis=(1, 2))
            rows = matrix.values[0].sum(axis=1)
            ours[bounces] = rows, np.sqrt(np.sum(total**2)) / rows.sum()
        rows, error = ours[bounces]
        command = (
            f"rfluxmtx -n 2 -h -I+ {settings} -y {len(rows)}"
            f" - {place.window} -i view.oct"
        )
        theirs = radiance(command, place.folder, text).sum(axis=1)
        share, mean = theirs.sum() / rows.sum(), np.mean(theirs / rows)
        lines.append(f"| `{settings}` | {share:.4f} | {mean:.4f} | {error:.5f} |")
    free = cl.view_matrix(scene, window, sensors=sensors, samples=1 << 17)
    part = ours[4][0].sum() / free.values[0].sum()
    lines += ["", f"Ours with `--bounces 4`, relative to no limit: {part:.3f}."]
    return "\n".join(lines)


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    text = table()
    print(text)
    if options.write:
        options.write.write_text(text + "\n")


if __name__ == "__main__":
    main()
