"""Pictures of the front page: a report, the glare of a year, and speed: docs/front/.

    python benchmarks/front_page.py [--results DIR]

The report is that of studies/office_standards, opened in Chromium; the glare is that of
the worst view of its view grid; the speed is read from the tables in docs/benchmarks.
"""

import argparse
import io
import subprocess
import tempfile
from pathlib import Path
from typing import NamedTuple

import numpy as np
from matplotlib.figure import Figure
from PIL import Image

from clerestory.report.figure_file import write_figure
from clerestory.report.glare_figures import glare_year_figure
from clerestory.report.page import picture_folder, write_report
from clerestory.report.pdf import find_browser
from clerestory.study.config import read_study
from clerestory.study.results import Results, read_results
from clerestory.study.study_run import run_study

ROOT = Path(__file__).parents[1]
STUDY = ROOT / "studies" / "office_standards" / "study.toml"
PICTURES, TABLES = ROOT / "docs" / "front", ROOT / "docs" / "benchmarks"

# Size of the screenshot [pixels], largest width of pictures, and JPEG quality
SCREEN, WIDTH, QUALITY = (1180, 1340), 900, 82


class Job(NamedTuple):
    """A row of a table in docs/benchmarks: ours, and the column of another program."""

    words: str
    file: str
    row: str
    column: str


JOBS = (
    Job("view matrix, 100 sensors", "view-matrix.md", "16,384 paths",
        "rfluxmtx tuned"),
    Job("daylight matrix", "daylight-matrix.md", "16,384 paths", "rfluxmtx tuned"),
    Job("BSDF of a blind from its geometry", "generate_bsdf.md", "8,192 paths",
        "genBSDF's port, tuned"),
    Job("picture behind a blind, in indirect light", "render.md", "64 paths",
        "rpict -aa 0 -ad 256"),
)  # fmt: skip


def ratio(job: Job) -> float:
    """Return the ratio of time × variance in the first table that has row and column.

    >>> ratio(JOBS[0])
    93.6
    """
    head: list[str] = []
    for line in (TABLES / job.file).read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if len(cells) > 2 and not cells[0]:
            head = cells
        columns = [k for k, cell in enumerate(head) if cell.startswith("× ")]
        found = [k for k in columns if head[k].startswith(f"× {job.column}")]
        if cells[0].startswith(job.row) and found:
            return float(cells[found[0]])
    message = f"{job.file}: no row {job.row!r} with a column {job.column!r}"
    raise ValueError(message)


def speed_figure() -> Figure:
    """Return bars of how much longer Radiance takes to the same error."""
    ratios = [ratio(job) for job in JOBS]
    figure = Figure(figsize=(8.6, 2.6), layout="constrained")
    axes = figure.subplots()
    place = np.arange(len(JOBS))[::-1]
    axes.barh(place, ratios, color="#7d9db9", height=0.62)
    axes.axvline(1, color="#1b1f24", linewidth=1)
    for at, found, job in zip(place, ratios, JOBS, strict=True):
        axes.text(found * 1.06, at, f"{found:.0f} × {job.column}", va="center")
    axes.set_yticks(place, [job.words for job in JOBS])
    axes.set(xscale="log", xlim=(1, 3000))
    axes.set_xticks([1, 10, 100, 1000], ["1", "10", "100", "1000"])
    axes.minorticks_off()
    axes.set_xlabel("work of Radiance (time × variance) in units of Clerestory's")
    axes.spines[["top", "right", "left"]].set_visible(False)
    axes.tick_params(axis="y", length=0)
    return figure


def glare_figure(results: Results) -> Figure:
    """Return the DGP of the worst view of the view grids over the year."""
    data = results.data
    worst = int(np.nanargmax(data["grid_view_exceeded_dgp"].values))
    return glare_year_figure(
        np.nan_to_num(data["grid_view_dgp"].values[worst].astype(float)),
        data["time"].values,
        use=data["occupied"].values.astype(bool),
        title="Office with blinds, the worst view",
    )


def screenshot(page: Path) -> None:
    """Write the top of a page as docs/front/report.jpg."""
    with tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as folder:
        shot = Path(folder) / "page.png"
        options = ("--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars")
        subprocess.run(
            [
                *(find_browser(), *options, f"--user-data-dir={folder}/profile"),
                *("--virtual-time-budget=10000", f"--screenshot={shot}"),
                "--window-size={},{}".format(*SCREEN),
                page.resolve().as_uri(),
            ],
            check=True,
            capture_output=True,
        )
        save(Image.open(io.BytesIO(shot.read_bytes())), PICTURES / "report.jpg")


def save(image: Image.Image, path: Path) -> None:
    """Write an image as JPEG, reduced to the width of the page."""
    height = round(image.height * WIDTH / image.width)
    small = image.convert("RGB").resize((WIDTH, height), Image.Resampling.LANCZOS)
    small.save(path, quality=QUALITY, optimize=True)


def main() -> None:
    """Run the study, unless its results are given, and write all pictures."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--results", type=Path, help="results of an earlier run")
    given = parser.parse_args().results
    PICTURES.mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        out = given or Path(folder)
        if given is None:
            run_study(read_study(STUDY), out=out)
        results = read_results(out)
        page = Path(folder) / "report.html"
        write_report(results, page, pictures=picture_folder(out, results))
        screenshot(page)
        write_figure(glare_figure(results), PICTURES / "glare.png")
    write_figure(speed_figure(), PICTURES / "speed.png")


if __name__ == "__main__":
    main()
