"""Every model at hand, ours over Radiance's: sensors under five skies and a picture.

    python benchmarks/models.py [--only WORD] [--write FILE]

Radiance runs without interpolation of indirect light (-aa 0), its rays cut as late as
they may; both count two bounces. Sensors are compared by the sum and by the worst of
them in units of the joint error, pictures by their mean luminance and by blocks.
"""

import argparse
import tempfile
import warnings
from pathlib import Path

import numpy as np
from duel import stamp
from model_scenes import (
    Model,
    boxes,
    classroom,
    furniture,
    honeybees,
    radiance,
    shapes,
    tutorial,
)

import clerestory as cl
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import Metal

BOUNCES = 2
SKIES = {
    "sunny": "gensky -ang 50 -30 +s",
    "clear": "gensky -ang 25 60 -s",
    "between": "gensky -ang 40 20 +i",
    "overcast": "gensky -ang 35 10 -c",
    "perez": "gendaylit -ang 45 40 -W 500 150",
}
DOME = (
    "\nskyfunc glow dome 0 0 4 1 1 1 0\ndome source sky 0 0 4 0 0 1 180\n"
    "dome source ground 0 0 4 0 0 -1 180\n"
)
LUMINANCE = np.array([0.265, 0.67, 0.065])

# Repetitions of a sensor
_AGAIN = 64

# Paths of a sensor of ours, and of a pixel
_SAMPLES, _PIXEL_SAMPLES = 1 << 15, 512

# Blocks along a side of a picture, and pixels of one in pictures of ours and theirs
_BLOCKS, _OURS, _THEIRS = 12, 4, (3, 4, 5, 6, 7, 8)

# Share of the mean that a sensor is taken to have at least, where errors are relative
_DARK = 0.05

_EXACT = "-aa 0 -as 0 -st 0 -lw 1e-8 -lr 8 -ds .05 -dj 1 -dc 1 -dt 0 -dr 3"

NOTES = """
Radiance's indirect light is gathered without interpolation, by 64 runs of rtrace with
32 first directions (in rooms 512) and by rpict in six sizes with 9 a pixel. Errors are
standard errors of both programs together. *Worst sensor*: its deviation over its value
(or 5 % of the mean, where it is darker), and in units of its own error, each the worst
of the 20 to 50 in a row.
*Blocks*: root mean square of the deviation of 12 × 12 blocks of the picture over its
mean, and in brackets the value expected from the standard errors.

**gensurf, metal.** The generator's `-s` smooths the sheet by a texture. Where a rough
highlight gathers light of the surroundings, Radiance weights samples by the angle to
the geometric normal instead of the perturbed one, unlike its own formula. Ours follows
the formula, as `tests/parity/test_finishes.py` shows with a sky of small suns, for
which Radiance evaluates the formula itself. Without the texture (gensurf_faceted) both
agree.

**Smooth surfaces under a sun.** The sun's image in a polished metal is smaller than a
pixel; pictures of models with polished metal are under the clear sky without sun.
Radiance omits sunlight that a smooth surface reflects to a matt one; ours includes it.
"""


def octree(model: Model, sky: str) -> list[str]:
    """Compile a model under a sky; return its files."""
    files = [*model.files]
    if sky:
        (model.folder / "the_sky.rad").write_text(f"!{SKIES[sky]}\n{DOME}")
        files.append("the_sky.rad")
    radiance(f"oconv {' '.join(files)} > model.oct", model.folder)
    return files


def sensors(model: Model, sky: str) -> tuple[float, float, float, float]:
    """Return ours over theirs, its error, and the worst sensor: in errors, relative."""
    files = octree(model, sky)
    point = np.concatenate([model.sensors.position, model.sensors.direction], axis=1)
    rays = np.repeat(point, _AGAIN, axis=0)
    # Single samples of highlights, which it takes of weak rays, overrate metals
    shine = 5000 if "metal" in model.name else 32
    text = radiance(
        f"rtrace -h -w -I -ab {BOUNCES} -ad {model.directions} -ss {shine} {_EXACT}"
        " model.oct",
        model.folder,
        "\n".join(" ".join(f"{x:.9g}" for x in ray) for ray in rays),
    )
    seen = np.array(text.split(), float).reshape(-1, _AGAIN, 3) @ LUMINANCE
    theirs, spread = seen.mean(axis=1), seen.std(axis=1, ddof=1) / _AGAIN**0.5
    ours = irradiance(
        cl.read_rad(*(model.folder / f for f in files)), model.sensors,
        samples=_SAMPLES, bounces=BOUNCES, seed=1, device="cpu",
    )  # fmt: skip
    own = ours.irradiance @ LUMINANCE
    error = np.hypot(ours.error @ LUMINANCE, spread)
    off = np.abs(own - theirs)
    worst = np.max(off / np.maximum(error, 1e-9))
    far = np.max(off / np.maximum(theirs, _DARK * theirs.mean()))
    total = theirs.sum()
    return own.sum() / total, np.sqrt((error**2).sum()) / total, worst, far


def in_blocks(values: np.ndarray) -> np.ndarray:
    """Return the means of a picture's blocks."""
    size = len(values) // _BLOCKS
    return values.reshape(_BLOCKS, size, _BLOCKS, size).mean(axis=(1, 3))


def picture(model: Model, sky: str) -> tuple[float, float, float, float]:
    """Return ours over theirs and its error; the blocks' deviation and their error."""
    files = octree(model, sky)
    runs = []
    for size in (_BLOCKS * each for each in _THEIRS):
        # Another size takes other samples
        radiance(
            f"rpict {model.view} -x {size} -y {size} -pa 0 -ab {BOUNCES} -ad 9 -ss 16"
            f" {_EXACT} -ps 1 -pt 0 -pj 1 model.oct > theirs.hdr",
            model.folder,
        )
        made = cl.read_picture(model.folder / "theirs.hdr")
        runs.append(in_blocks(made.radiance.astype(float) @ LUMINANCE))
    theirs, weak = np.mean(runs, axis=0), len(runs) ** 0.5
    spread = np.std(runs, axis=0, ddof=1) / weak
    ours = cl.render(
        cl.read_rad(*(model.folder / f for f in files)), cl.parse_view(model.view),
        columns=_BLOCKS * _OURS, rows=_BLOCKS * _OURS, samples=_PIXEL_SAMPLES,
        bounces=BOUNCES, seed=1, device="cpu",
    )  # fmt: skip
    own = in_blocks(ours.picture.radiance.astype(float) @ LUMINANCE)
    noise = np.sqrt(in_blocks((ours.error @ LUMINANCE) ** 2)) / _OURS
    level, means = theirs.mean(), [run.mean() for run in runs]
    error = np.hypot(np.std(means, ddof=1) / weak, np.sqrt((noise**2).mean()) / _BLOCKS)
    off = np.sqrt(np.mean((own - theirs) ** 2))
    expected = np.sqrt(np.mean(noise**2 + spread**2))
    return own.mean() / level, error / level, off / level, expected / level


def polished(model: Model) -> bool:
    """Return whether a model has metals that mirror."""
    scene = cl.read_rad(*(model.folder / f for f in model.files))
    metals = (m for m in scene.materials.values() if isinstance(m, Metal))
    return any(m.specularity > 0 and m.roughness == 0 for m in metals)


def row(model: Model) -> str:
    """Return a model's row of the table."""
    cells, worst = [], []
    for sky in SKIES:
        if model.shines and cells:
            cells.append("")
            continue
        try:
            share, error, sigma, far = sensors(model, "" if model.shines else sky)
        except (cl.ClerestoryError, RuntimeError) as refused:
            reason = str(refused).strip().splitlines()[0].rsplit("rtrace: ", 1)[-1]
            return f"| {model.name} | refused: {reason} |" + " |" * (len(SKIES) + 2)
        cells.append(f"{share:.4f} ± {error:.4f}")
        worst.append((far, sigma))
    far, sigma = max(worst)
    seen_under = "clear" if polished(model) else "sunny"
    share, error, off, noise = picture(model, "" if model.shines else seen_under)
    cells += [f"{far:.1%}, {sigma:.1f} σ", f"{share:.4f} ± {error:.4f}"]
    return f"| {model.name} | {' | '.join(cells)} | {off:.1%} ({noise:.1%}) |"


def main() -> None:
    """Read the command line, run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--only", default="", help="models whose name holds this word")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    warnings.simplefilter("ignore")
    lines = [
        "# Every model at hand, ours over Radiance's",
        "",
        "Made by `benchmarks/models.py`. " + stamp(),
        "",
        f"| model | {' | '.join(SKIES)} | worst sensor | picture | blocks |",
        "|---" * (len(SKIES) + 4) + "|",
    ]
    with tempfile.TemporaryDirectory() as place:
        for group in (boxes, shapes, tutorial, honeybees, classroom, furniture):
            for model in group(Path(place, group.__name__)):
                if options.only in model.name:
                    lines.append(row(model))
                    print(lines[-1], flush=True)
    if options.write:
        options.write.write_text("\n".join(lines) + "\n" + NOTES)


if __name__ == "__main__":
    main()
