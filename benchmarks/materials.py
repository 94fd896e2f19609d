"""How far rooms of every material are from rtrace.

    python benchmarks/materials.py [--write FILE]

Four sensors in a box with a roof and a wall of the material: the sum of their
irradiance over rtrace's under a sky and under a sun, and the same of the rows of the
view matrix of a window. Both programs count two bounces.
"""

import argparse
import sys
import tempfile
from pathlib import Path

import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.phases.rendering import irradiance
from clerestory.scene.sensors import Sensors

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))
from material_rooms import BOX, DIRECTION, LIGHT, POSITION, WINDOW, seen_by_radiance
from material_texts import SHEETS

_SENSORS = Sensors(POSITION, DIRECTION)

# Samples that rtrace takes of the highlights of metals, which its single ones overrate
_HIGHLIGHT = 20_000


def instant(folder: Path, text: str, light: str, highlight: int) -> str:
    """Return how much the sensors read under a sky or a sun, over rtrace's."""
    (folder / "room.rad").write_text("\n".join([text, BOX, LIGHT[light]]))
    ours = irradiance(
        cl.read_rad(folder / "room.rad"),
        _SENSORS,
        samples=1 << 16,
        bounces=2,
        device="cpu",
    )
    theirs = seen_by_radiance(
        folder, "room.rad", bounces=2, highlight=highlight, again=16
    )
    return _ratio(ours.irradiance, ours.error, *theirs)


def view(folder: Path, text: str, highlight: int) -> str:
    """Return how much the rows of a view matrix hold, over what rtrace reads."""
    (folder / "room.rad").write_text("\n".join([text, BOX]))
    (folder / "window.rad").write_text(WINDOW)
    matrix = cl.view_matrix(
        cl.read_rad(folder / "room.rad"),
        cl.read_window(folder / "window.rad"),
        sensors=_SENSORS,
        samples=1 << 15,
        bounces=2,
        device="cpu",
    )
    own = np.square(matrix.components.sum(axis=3)).sum(axis=0).T ** 0.5
    files = "room.rad window.rad"
    theirs = seen_by_radiance(folder, files, bounces=2, highlight=highlight, again=16)
    return _ratio(matrix.values.sum(axis=2).T, own, *theirs)


def _ratio(ours: np.ndarray, own: np.ndarray, theirs: np.ndarray, error: np.ndarray):
    # Of the sums over sensors, with the errors of both; red channel
    total, other = ours[:, 0].sum(), theirs[:, 0].sum()
    spread = np.hypot(own[:, 0], error[:, 0])
    return f"{total / other:.4f} ± {np.sqrt(np.sum(spread**2)) / other:.4f}"


def table() -> str:
    """Return a Markdown table of ours over rtrace's."""
    lines = [
        "### Rooms of every material, ours over rtrace's",
        "",
        stamp(),
        "",
        "| material | under a sky | under a sun | view of a window |",
        "|---|---|---|---|",
    ]
    for name, text in SHEETS.items():
        highlight = _HIGHLIGHT if name.startswith("metal") else 32
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            cells = [instant(folder, text, light, highlight) for light in LIGHT]
            cells.append(view(folder, text, highlight))
        lines.append(f"| {name} | {' | '.join(cells)} |")
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
