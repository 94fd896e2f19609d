"""Glare against evalglare: the same numbers, the time they take, the imageless error.

    OMP_NUM_THREADS=1 python benchmarks/glare.py [--pictures N] [--write FILE]

Times are processor seconds, so that a busy machine does not change them, and hold the
reading of the file for both; ours are of one thread but for the first picture through a
view, which takes all cores.
"""

import argparse
import resource
import subprocess
import sys
import tempfile
import time
import warnings
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "parity"))

from duel import ENVIRONMENT, stamp
from evalglare import INDICES, evalglare
from glare_pictures import KINDS, VIEWS, synthetic_picture

from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.evaluate import evaluate_glare
from clerestory.glare.glare_view import GlareView, _glare_view, glare_view
from clerestory.glare.imageless import imageless_dgp
from clerestory.glare.indices import Glare
from clerestory.image.picture import Picture
from clerestory.image.picture_files import read_picture, write_picture
from clerestory.scene.view import View

FISHEYE = View(kind="angular", horizontal=180, vertical=180)
SIZE, STEPS = 800, 24
BLOCK = 25
ANGLE = 2e-4  # what evalglare's digits may hide [°]


def timed(work: Callable[[], object]) -> float:
    """Processor seconds of a piece of work."""
    begin = time.process_time()
    work()
    return time.process_time() - begin


def child_time(*command: str | Path) -> float:
    """Processor seconds of a program."""
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run(command, env=ENVIRONMENT, capture_output=True, check=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def their_time(path: Path) -> float:
    """Processor seconds of evalglare as it comes, without -d."""
    return child_time("evalglare", path)


def command_time(path: Path) -> float:
    """Processor seconds of `clerestory glare`, start of the program and all."""
    start = "from clerestory.cli.main import main; raise SystemExit(main())"
    return child_time(sys.executable, "-c", start, "glare", path)


def from_file(path: Path) -> Glare:
    """Read a picture and evaluate it, as evalglare does."""
    return evaluate_glare(read_picture(path))


def parity(folder: Path, pictures: int) -> list[str]:
    """Return a table of what differs, by view."""
    rows: dict[str, list[tuple[bool, float, float]]] = {}
    apart: list[np.ndarray] = []
    for number in range(pictures):
        path = folder / "synthetic.hdr"
        write_picture(synthetic_picture(number), path)
        theirs = evalglare(path)
        ours = evaluate_glare(read_picture(path), trust=True)
        values = ours.values()
        worst = max(
            abs(values[name] - theirs.summary[key]) / (abs(theirs.summary[key]) + 1e-3)
            for key, name in INDICES.items()
        )
        kind = VIEWS[number % len(VIEWS)]
        same = ours.sources.count == theirs.count
        rows.setdefault(kind, []).append(
            (same, abs(values["dgp"] - theirs.summary["dgp"]), worst)
        )
        if same and theirs.count:
            apart.append(angles(ours, theirs.sources))
    lines = [
        "| view | pictures | same number of sources | largest error of DGP | of another"
        " index |",
        "|---|---|---|---|---|",
    ]
    for kind, found in rows.items():
        same, dgp, other = zip(*found, strict=True)
        lines.append(
            f"| `{kind}` | {len(found)} | {sum(same)} | {max(dgp):.1e}"
            f" | {max(other):.2%} |"
        )
    off, sure = np.concatenate(apart, axis=1)
    far, known = off > ANGLE, sure > 0
    lines += [
        "",
        f"Of {off.size} sources {np.count_nonzero(far)} are looked up in the pixel"
        f" beside evalglare's, {np.count_nonzero(far & known)} of them among the"
        f" {np.count_nonzero(known)} whose middle is not on the edge of a pixel. It"
        " moves veiling luminances only.",
    ]
    return lines


def angles(ours: Glare, sources: list[list[float]]) -> np.ndarray:
    """Of each source the difference of its angle [°], and 1 where rounding is out."""
    place = np.stack([ours.sources.row, ours.sources.column])
    sure = np.abs(place - np.round(place)).min(axis=0) > 1e-6
    return np.stack(
        [np.abs(np.degrees(ours.sources.sigma) - np.array(sources)[:, 12]), sure]
    )


def desk(step: int) -> np.ndarray:
    """Luminance of a room with a window at one step of a bright day [cd/m²]."""
    rng = np.random.default_rng(step)
    row, column = np.mgrid[:SIZE, :SIZE]
    sky = 1200 + 6000 * np.sin(np.pi * (step % 12 + 1) / 13)
    luminance = 0.03 * sky * (1 + 0.2 * np.sin(row / 190) + 0.1 * np.cos(column / 130))
    for pane in range(4):
        left = 90 + 90 * pane
        glass = np.s_[260:470, left : left + 78]
        luminance[glass] = sky * (1.3 - (row[glass] - 260) / 300)
    if step % 2:
        at = 300 + 6 * (step % 20), 110 + 14 * step
        luminance[np.hypot(row - at[0], column - at[1]) < 1.3] = 4e8
        patch = np.s_[600:660, 200 + 10 * step : 300 + 10 * step]
        luminance[patch] = 9000
    return luminance * rng.uniform(0.97, 1.03, luminance.shape)


def speed(folder: Path, photographs: list[Path]) -> tuple[list[str], list[np.ndarray]]:
    """Return a table of times of single pictures, and the steps of a day."""
    lines = [
        "| picture | evalglare | as a command | × | first through a view | × |"
        " next through it | × |",
        "|---|---|---|---|---|---|---|---|",
    ]
    steps = [desk(step) for step in range(STEPS)]
    for step in (0, 1):
        path = folder / f"desk{step}.hdr"
        grey = (steps[step] / 179).astype(np.float32)
        write_picture(
            Picture(np.repeat(grey[..., None], 3, axis=2), view=FISHEYE), path
        )
        photographs = [*photographs, path]
    for path in photographs:
        picture = read_picture(path)
        theirs = min(their_time(path) for _ in range(2))
        _glare_view.cache_clear()
        evaluate = partial(from_file, path)
        first = timed(evaluate)
        following = min(timed(evaluate) for _ in range(7))
        command = min(command_time(path) for _ in range(2))
        name = f"{path.stem}, {picture.columns} × {picture.rows}"
        lines.append(
            f"| {name} | {theirs:.2f} s | {command:.2f} s | {theirs / command:.1f}"
            f" | {first:.2f} s | {theirs / first:.1f}"
            f" | {following:.3f} s | {theirs / following:.0f} |"
        )
    return lines, steps


def year(folder: Path, steps: list[np.ndarray]) -> list[str]:
    """Return a table of times of a day and its night."""
    stack = np.stack(steps).astype(np.float32)
    # Of a year's hours half are dark
    stack = np.concatenate([stack, np.zeros_like(stack)])
    annual_glare(stack[:1], FISHEYE)
    ours = min(timed(lambda: annual_glare(stack, FISHEYE)) for _ in range(2))
    theirs = 0.0
    for i in (0, 1, len(stack) - 1):
        path = folder / "step.hdr"
        grey = stack[i] / np.float32(179)
        write_picture(
            Picture(np.repeat(grey[..., None], 3, axis=2), view=FISHEYE), path
        )
        theirs += their_time(path) * (0.5 if i > 1 else 0.25)
    each = ours / len(stack)
    return [
        "| | a step | a year of 8760 | × |",
        "|---|---|---|---|",
        f"| evalglare, pictures on disk already | {theirs:.2f} s |"
        f" {theirs * 8760 / 3600:.1f} h | 1 |",
        f"| `annual_glare` | {each:.4f} s | {each * 8760 / 60:.1f} min |"
        f" {theirs / each:.0f} |",
    ]


def coarse(eye: GlareView, luminance: np.ndarray) -> tuple[np.ndarray, ...]:
    """What a view matrix tells: patches of the window, and the sun on its own."""
    sun = luminance > 1e7
    dim = np.where(sun, 0, luminance)
    count = SIZE // BLOCK

    def blocks(values: np.ndarray) -> np.ndarray:
        return values.reshape(count, BLOCK, count, BLOCK).sum(axis=(1, 3)).ravel()

    omega = blocks(eye.solid_angle)
    patch = blocks(eye.solid_angle * dim) / np.maximum(omega, 1e-12)
    index = blocks(eye.solid_angle * eye.position_index) / np.maximum(omega, 1e-12)
    extra = eye.solid_angle[sun].sum()
    level = (eye.solid_angle * luminance)[sun].sum() / max(extra, 1e-12)
    at = eye.position_index[sun].mean() if sun.any() else 1.0
    return (
        np.append(patch, level),
        np.append(omega, extra),
        np.append(np.maximum(index, 1), at),
    )


def imageless(steps: list[np.ndarray]) -> list[str]:
    """Return a table of the error of DGP without pictures."""
    eye = glare_view(FISHEYE, SIZE, SIZE)
    truth = annual_glare(steps, FISHEYE)
    error = []
    for step, luminance in enumerate(steps):
        level, omega, index = coarse(eye, luminance)
        dgp = imageless_dgp(
            truth.illuminance.values[step : step + 1],
            luminance=level[:, None],
            solid_angle=omega[:, None],
            index=index[:, None],
        )
        error.append(float(dgp[0]) - float(truth.dgp[step]))
    error_ = np.array(error)
    return [
        "| steps | mean error | mean absolute | largest |",
        "|---|---|---|---|",
        f"| {error_.size} | {error_.mean():+.4f} | {np.abs(error_).mean():.4f}"
        f" | {np.abs(error_).max():.4f} |",
    ]


def main() -> None:
    """Measure, print and write."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--pictures", type=int, default=200)
    parser.add_argument("--photographs", type=Path, nargs="*", default=[])
    parser.add_argument("--write", type=Path)
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        fast, steps = speed(folder, options.photographs)
        annual = year(folder, steps)
        same = parity(folder, options.pictures)
    text = [
        "# Glare against evalglare 3.06",
        "",
        f"{stamp()}; processor seconds.",
        "",
        "## One picture",
        "",
        *fast,
        "",
        "## A year",
        "",
        f"A bright day and its night, {2 * STEPS} pictures of {SIZE} × {SIZE} pixels.",
        "",
        *annual,
        "",
        "## The same numbers",
        "",
        f"Synthetic pictures of {len(KINDS)} kinds, 160 pixels wide.",
        "",
        *same,
        "",
        "## Without pictures",
        "",
        f"DGP of patches of {180 * BLOCK / SIZE:.1f}° and the sun against that of the"
        " whole pictures.",
        "",
        *imageless(steps),
        "",
    ]
    print("\n".join(text))
    if options.write:
        options.write.write_text("\n".join(text), encoding="utf-8")


if __name__ == "__main__":
    main()
