"""A large hall: 5 million triangles, 100,000 sensors, 40 windows, 5 states, 8760 hours.

    python benchmarks/large_model.py run [--triangles 5e6] [--sensors 1e5]
        [--windows 40] [--states 5] [--samples 1024] [--folder DIR] [--write FILE]
    python benchmarks/large_model.py sweep [--write FILE]

`run` writes the hall as a study of its own, with an OBJ file of the triangles, and runs
it as `clerestory run` does: a year with shades that close by the sun on each facade, to
results.nc and report.html. `sweep` runs smaller halls in processes of their own, one
size at a time growing, and plots how seconds and memory grow. The files of a run take
2.9 kB for each sensor and window, and 140 kB of hours for each sensor.
"""

import argparse
import json
import os
import resource
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from datetime import date
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
from hall import facade, polygon_text, sensors_of, shell, space_frame, write_obj
from matplotlib.ticker import MaxNLocator

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems
from clerestory.report.page import write_report
from clerestory.study.config import read_study
from clerestory.study.new_study import write_demo
from clerestory.study.run_plan import plan_study
from clerestory.study.study_run import run_study

# Stages of a run, by how the display of its phases begins
STAGES = {
    "view": "views",
    "daylight": "daylight, sky, states",
    "multiply": "product, metrics, files",
}


@dataclass
class Log:
    """Seconds of the clock and of the processors, and most memory, by stage."""

    stages: dict[str, dict[str, float]] = field(default_factory=dict)
    name: str = "read"
    begin: float = field(default_factory=time.perf_counter)
    used: float = field(default_factory=time.process_time)
    marks: dict[str, list[tuple[float, float]]] = field(default_factory=dict)

    def enter(self, name: str) -> None:
        """End the stage and begin another; the same one goes on."""
        if name == self.name:
            return
        self.stages[self.name] = {
            "seconds": time.perf_counter() - self.begin,
            "cpu": time.process_time() - self.used,
            "peak_gb": peak_gb(),
        }
        print(f"{self.name}: {json.dumps(self.stages[self.name])}", flush=True)
        self.begin, self.used = time.perf_counter(), time.process_time()
        self.name = name

    def display(self, phase: str):
        """Begin the stage of a phase of the run; note how its work goes on."""
        self.enter(STAGES[phase.split()[0]])
        marks = self.marks.setdefault(self.name, [(0.0, time.process_time())])
        return lambda share, _note: marks.append((share, time.process_time()))

    def fifths(self, name: str) -> list[float]:
        """Return the processor seconds of each fifth of a stage's work."""
        share, used = np.array(self.marks[name]).T
        return np.diff(np.interp(np.linspace(0, 1, 6), share, used)).tolist()


def peak_gb() -> float:
    """Return the most memory that the process has had [GB]."""
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1e6


def write_study(options: argparse.Namespace, folder: Path) -> Path:
    """Write the hall as a study and return its file."""
    walls, windows = facade(options.windows)
    write_obj(space_frame(int(options.triangles)), folder / "frame.obj")
    lines = ["void plastic grey 0 0 5 0.5 0.5 0.5 0 0"]
    lines += [polygon_text("grey", n, p) for n, p in enumerate((*shell(), *walls))]
    lines += ["grey mesh frame 1 frame.obj 0 0"]
    (folder / "hall.rad").write_text("\n".join(lines) + "\n")
    lines = ["#@rfluxmtx h=kf u=Z"]
    for window in windows:
        lines += [f"void glow {window.name} 0 0 4 1 1 1 0"]
        lines += [polygon_text(window.name, 1, p) for p in window.polygons]
    (folder / "windows.rad").write_text("\n".join(lines) + "\n")
    sensors = sensors_of(int(options.sensors))
    places = np.column_stack([sensors.position, sensors.direction])
    np.savetxt(folder / "desks.pts", places, fmt="%.4f")
    tables = ""
    for number, t in enumerate(np.linspace(0.6, 0.05, options.states)):
        write_bsdf(folder / f"state{number}.xml", lambertian(t, klems("full")))
        tables += f'[[window.state]]\nname = "{number}"\nbsdf = "state{number}.xml"\n'
    if options.states > 1:
        levels = np.linspace(0, 400, options.states)[1:].tolist()
        tables += f'[window.control]\nrule = "threshold"\nclose_above = {levels}\n'
    else:
        tables = 'bsdf = "state0.xml"\n'
    write_demo(folder / "demo")
    weather = options.weather or next(folder.glob("demo/*.CSV"))
    (folder / "study.toml").write_text(f"""title = "Hall"
method = "3-phase"
[scene]
files = ["hall.rad"]
[[window]]
name = "facade"
file = "windows.rad"
{tables}
[[sensors]]
file = "desks.pts"
[weather]
file = "{weather.resolve()}"
[sky]
subdivision = {options.subdivision}
[trace]
samples = {options.samples}
memory_gb = {options.memory_gb}
device = "{options.device}"
[output]
csv = false
""")
    return folder / "study.toml"


def simulate(options: argparse.Namespace, folder: Path) -> Log:
    """Simulate the year of a hall, after a plan of it."""
    study, out = read_study(write_study(options, folder)), folder / "results"
    plan = plan_study(study, out=out) if options.plan else None
    log, begin, used = Log(), time.perf_counter(), time.process_time()
    results = run_study(study, out=out, display=log.display)
    log.enter("report")
    write_report(results, out / "report.html")
    log.enter("")
    files = [f for f in out.rglob("*") if f.is_file()]
    seconds = results.run["seconds"]
    log.stages["total"] = {
        "seconds": time.perf_counter() - begin,
        "cpu": time.process_time() - used,
        "peak_gb": peak_gb(),
        "disk_gb": sum(f.stat().st_size for f in files) / 1e9,
        "trace": seconds["trace"],
    }
    for stage, name in (("views", "views"), ("product", STAGES["multiply"])):
        log.stages[f"fifths of {stage}"] = log.fifths(name)
    if plan is not None:
        log.stages["plan"] = {
            "seconds": plan.seconds, "memory": plan.memory, "disk": plan.disk,
        }  # fmt: skip
    print(json.dumps(log.stages["total"]), flush=True)
    return log


# Sizes that a sweep begins with, and how many times larger they grow, one at a time
BASE = {"triangles": 100_000, "sensors": 1000, "windows": 4, "states": 2}
GROWTH = {
    "triangles": (1, 8, 32),
    "sensors": (1, 4, 16),
    "windows": (1, 4, 10),
    "states": (1, 2, 4),
}


def sweep(options: argparse.Namespace) -> dict[str, list[tuple[float, dict]]]:
    """Return the stages of halls that differ in one size each."""
    in_a_process(BASE, options)  # compiles the kernels
    base = in_a_process(BASE, options)
    found: dict[str, list[tuple[float, dict]]] = {}
    for name, factors in GROWTH.items():
        found[name] = [(BASE[name], base)]
        for factor in factors[1:]:
            sizes = BASE | {name: BASE[name] * factor}
            found[name].append((sizes[name], in_a_process(sizes, options)))
    return found


def in_a_process(sizes: dict[str, int], options: argparse.Namespace) -> dict:
    """Return the stages of a run in a process of its own."""
    words = [f"--{name}={size}" for name, size in sizes.items()]
    words += [f"--samples={options.samples}", f"--device={options.device}"]
    words += [f"--subdivision={options.subdivision}"]
    words += [f"--memory-gb={options.memory_gb}"]
    if options.weather:
        words.append(f"--weather={options.weather}")
    print(" ".join(words), flush=True)
    with tempfile.TemporaryDirectory(dir=options.folder) as folder:
        stages = Path(folder) / "stages.json"
        subprocess.run(
            [sys.executable, __file__, "run", *words, f"--folder={folder}",
             f"--stages={stages}"],
            check=True,
        )  # fmt: skip
        return json.loads(stages.read_text())


def plot(found: dict[str, list[tuple[float, dict]]], path: Path) -> None:
    """Draw seconds of processors by stage, and memory, over each size."""
    figure, axes = plt.subplots(
        2, len(found), figsize=(12, 5.5), sharey="row", layout="constrained"
    )
    stages = ("read", *STAGES.values(), "report", "total")
    for column, (name, runs) in enumerate(found.items()):
        sizes = [size for size, _ in runs]
        for stage in stages:
            cpu = [run[stage]["cpu"] for _, run in runs]
            axes[0, column].plot(sizes, cpu, "o-", label=stage)
        axes[1, column].plot(sizes, [r["total"]["peak_gb"] for _, r in runs], "o-")
        axes[1, column].set_xlabel(name)
        axes[0, column].set_title(f"growing {name}", fontsize=10)
        for row in (0, 1):
            axes[row, column].grid(alpha=0.3)
            axes[row, column].set_xlim(0, 1.1 * max(sizes))
            axes[row, column].xaxis.set_major_locator(MaxNLocator(4))
    axes[0, 0].set_ylabel("processor seconds")
    for row in axes[:, 0]:
        row.set_ylim(bottom=0)
    axes[1, 0].set_ylabel("most memory [GB]")
    axes[0, -1].legend(fontsize=8)
    figure.savefig(path, dpi=110)


def head(what: str) -> str:
    """Return the heading of a table, with date and machine."""
    return (
        f"### {what}\n\n{date.today()}, {os.cpu_count()} cores, clerestory"  # noqa: DTZ011
        f" {cl.__version__}, load {os.getloadavg()[0]:.1f} at the end.\n\n"
    )


def table(stages: dict[str, dict]) -> str:
    """Return the stages as a table."""
    lines = ["| stage | seconds | processor seconds | most memory so far [GB] |"]
    lines.append("|---|---|---|---|")
    for name, stage in stages.items():
        if name == "plan" or name.startswith("fifths"):
            continue
        figures = (
            f"{stage['seconds']:.1f} | {stage['cpu']:.1f} | {stage['peak_gb']:.2f}"
        )
        lines.append(f"| {name} | {figures} |")
    return "\n".join(lines) + "\n"


def plan_text(stages: dict[str, dict]) -> str:
    """Return a comparison of the plan with the run."""
    if "plan" not in stages:
        return ""
    plan, total = stages["plan"], stages["total"]
    return (
        f"\nEstimates of `--plan`, and values of the run: {plan['seconds']:.0f} s and"
        f" {total['trace']:.0f} s to trace, ratio"
        f" {plan['seconds'] / total['trace']:.2f};"
        f" {plan['memory'] / 1e9:.1f} GB and {total['peak_gb']:.1f} GB of memory;"
        f" {plan['disk'] / 1e9:.1f} GB and {total['disk_gb']:.1f} GB of disk.\n"
    )


def flat_text(stages: dict[str, dict], sensors: float) -> str:
    """Return how many sensors a second were done, from the first to the last."""
    text = ""
    for name in ("views", "product"):
        rates = [f"{sensors / 5 / used:.0f}" for used in stages[f"fifths of {name}"]]
        text += (
            f"\nSensors a processor second, {name}, fifth by fifth of them:"
            f" {', '.join(rates)}.\n"
        )
    return text + "T D S of all windows comes before the first fifth of the product.\n"


def growth_table(found: dict[str, list[tuple[float, dict]]]) -> str:
    """Return seconds and memory at each size as a table, and what one more takes."""
    stages = ("read", *STAGES.values(), "report", "total")
    first = "| growing | size |" + "".join(f" {stage} |" for stage in stages)
    lines = [f"{first} memory [GB] |", "|---" * (len(stages) + 3) + "|"]
    for name, runs in found.items():
        for size, run in runs:
            parts = " | ".join(f"{run[stage]['cpu']:.1f}" for stage in stages)
            peak = run["total"]["peak_gb"]
            lines.append(f"| {name} | {size:,} | {parts} | {peak:.2f} |")
    text = "\n".join(lines) + "\n\nFrom the first size to the last, one more takes:\n\n"
    return (
        text + "\n".join(_one_more(name, runs) for name, runs in found.items()) + "\n"
    )


def _one_more(name: str, runs: list[tuple[float, dict]]) -> str:
    # The slope of each stage, in milliseconds, for a thousand triangles in place of one
    (small, low), (large, high) = runs[0], runs[-1]
    many = 1000 if name == "triangles" else 1
    parts = []
    for stage in ("read", *STAGES.values(), "report"):
        slope = many * (high[stage]["cpu"] - low[stage]["cpu"]) / (large - small)
        parts.append(f"{stage} {1e3 * slope:.1f}")
    unit = "thousand triangles" if many > 1 else name.removesuffix("s")
    return f"- {unit}: processor milliseconds: {'; '.join(parts)}"


def main() -> None:
    """Run one hall or the sweep, and print or write what it took."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("job", choices=("run", "sweep"))
    parser.add_argument("--triangles", type=float, default=5e6)
    parser.add_argument("--sensors", type=float, default=1e5)
    parser.add_argument("--windows", type=int, default=40)
    parser.add_argument("--states", type=int, default=5)
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--memory-gb", type=float, default=0.1, help="of the study")
    parser.add_argument("--plan", action="store_true", help="compare with --plan")
    parser.add_argument("--subdivision", type=int, default=4)
    parser.add_argument("--weather", type=Path)
    parser.add_argument("--device", default="auto")
    parser.add_argument("--folder", type=Path, default=Path(tempfile.gettempdir()))
    parser.add_argument("--stages", type=Path)
    parser.add_argument("--write", type=Path, help="a page; a plot goes beside it")
    options = parser.parse_args()
    if options.job == "run":
        with tempfile.TemporaryDirectory(dir=options.folder) as folder:
            log = simulate(options, Path(folder))
        if options.stages:
            options.stages.write_text(json.dumps(log.stages))
        what = (
            f"{options.triangles:,.0f} triangles, {options.sensors:,.0f} sensors,"
            f" {options.windows} windows with {options.states} states, a year at MF"
            f" {options.subdivision}, {options.samples} paths a sensor"
        )
        text = head(what) + table(log.stages)
        text += f"\nFiles: {log.stages['total']['disk_gb']:.1f} GB.\n"
        text += flat_text(log.stages, options.sensors)
        text += plan_text(log.stages)
    else:
        found = sweep(options)
        text = head("Growth with the size of a model") + growth_table(found)
        if options.write:
            picture = options.write.with_suffix(".png")
            plot(found, picture)
            text += f"\n![Growth of time and memory]({picture.name})\n"
    print(text)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
