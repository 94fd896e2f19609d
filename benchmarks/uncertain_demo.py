"""Total uncertainty of the demo, against rooms traced again with drawn reflectances.

    python benchmarks/uncertain_demo.py [--draws 200] [--write]

All eight reflectances of `clerestory demo` are normal, ±0.05. The run expands them to
second order; here each drawn room is traced whole, with the seeds of the study, and the
year computed from its matrices. Written to docs/validation/uncertain-demo.md.
"""

import argparse
import tempfile
from pathlib import Path
from time import process_time

import numpy as np
import xarray as xr
from duel import stamp

from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.study.config import read_study
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.new_study import write_demo
from clerestory.study.operated_study import operated
from clerestory.study.retracing import retraced
from clerestory.study.study_run import run_study
from clerestory.study.uncertain_figures import grid_figures, light
from clerestory.study.unknown_quantities import unknown_quantities

PAGE = Path(__file__).parents[1] / "docs" / "validation" / "uncertain-demo.md"

MATERIALS = (
    "ceiling", "wall", "floor", "reveal", "facade", "ground", "desk", "screen",
)  # fmt: skip
_SHARES, _SEED = (0.05, 0.95), 25


def uncertain_demo(folder: Path, deviation: float) -> Path:
    """Write the demo with all reflectances unknown; return its study file."""
    file = write_demo(folder)
    tables = "".join(
        f'\n[[uncertainty.unknown]]\nkind = "reflectance"\nmaterial = "{name}"\n'
        f"standard_deviation = {deviation}\n"
        for name in MATERIALS
    )
    file.write_text(f"{file.read_text()}\n[uncertainty]\ndraws = 2048\n{tables}")
    return file


def traced_figures(
    file: Path, data: xr.Dataset, numbers: range
) -> tuple[np.ndarray, float]:
    """Return figures of drawn rooms over (draw, figure); processor time of a room [s].

    `numbers` are those of the draws, each of which has a seed of its own.
    """
    study = read_study(file)
    inputs = read_inputs(study)
    unknowns = unknown_quantities(study, inputs, study.uncertainty.unknown)
    hours = np.flatnonzero(data["occupied"].values)
    grid, target = data["grid"].values.astype(str), float(data.attrs["target_lux"])
    rows, spent = [], []
    with tempfile.TemporaryDirectory() as folder:
        job = Job(study, inputs, MatrixStore(Path(folder)), silent)
        situation = operated(job).at(hours)
        for number in numbers:
            start = process_time()
            rng = np.random.default_rng([_SEED, number])
            named = {
                own.name: float(own.distribution.quantiles(rng.random(1))[0])
                for own in unknowns.unknowns
            }
            room = retraced(job, unknowns.of_materials(named), situation)
            metrics = light(room.lux(), target)[:, None]
            rows.append([float(own[0]) for own in grid_figures(metrics, grid)])
            spent.append(process_time() - start)
    return np.array(rows), float(np.median(spent))


def quantile_error(values: np.ndarray, share: float) -> float:
    """Return the standard error of a quantile, by the bootstrap."""
    picks = np.random.default_rng(_SEED).integers(0, len(values), (1000, len(values)))
    return float(np.quantile(values[picks], share, axis=1).std())


def page(data: xr.Dataset, traced: np.ndarray, seconds: float, whole: float) -> str:
    """Return the page: both distributions of each figure."""
    rows, scores = [], []
    for k, own in enumerate(traced.T):
        drawn = data["known_figure_draws"].values[k].astype(float)
        name, place, unit = (
            str(data[f"known_figure_{part}"].values[k])
            for part in ("name", "place", "unit")
        )
        pairs = [(drawn.mean(), own.mean(), own.std(ddof=1) / np.sqrt(len(own)))]
        pairs += [
            (np.quantile(drawn, s), np.quantile(own, s), quantile_error(own, s))
            for s in _SHARES
        ]
        scores += [(b - a) / error for a, b, error in pairs if error > 0]
        cells = " | ".join(f"{a:.5g} | {b:.5g} ± {e:.2g}" for a, b, e in pairs)
        rows.append(f"| {name}, {place} [{unit}] | {cells} |")
    scores = np.abs(scores)
    table = "\n".join(rows)
    return f"""# Total uncertainty of the demo

`benchmarks/uncertain_demo.py`. {stamp()}

`clerestory demo` with all eight reflectances unknown, normal, ±0.05:
[`[uncertainty]`](../uncertainty.md) draws 2,048 rooms and computes them by expansion to
second order. Here {len(traced)} further rooms, drawn at random, were traced whole and
their year was computed. "expanded" are values of the expansion, "traced" those of the
rooms; ± is the standard error of {len(traced)} draws.

| | mean, expanded | traced | 5 %, expanded | traced | 95 %, expanded | traced |
|---|---|---|---|---|---|---|
{table}

Of {len(scores)} pairs with a standard error above zero, {np.sum(scores < 2)} differ by
less than two of them and {np.sum(scores < 4)} by less than four; the largest difference
is {scores.max():.1f}. The rooms have the seeds of the study, so that most of the random
error of the trace is common to both. Grids of few sensors change their area in steps of
one sensor.

The run with its draws, Sobol' indices and four checks took {whole:.0f} s of processor
time, a traced room {seconds:.1f} s.
"""


def main() -> None:
    """Read the command line, run, print or write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--draws", type=int, default=200)
    parser.add_argument("--write", action="store_true")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        file = uncertain_demo(Path(folder) / "demo", 0.05)
        start = process_time()
        data = run_study(read_study(file), out=Path(folder) / "out").data
        whole = process_time() - start
        traced, seconds = traced_figures(file, data, range(options.draws))
    text = page(data, traced, seconds, whole)
    if options.write:
        PAGE.write_text(text)
    else:
        print(text)


if __name__ == "__main__":
    main()
