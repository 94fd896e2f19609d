"""Optimisation of a study: search of designs, and full runs of the best ones."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.escaping import csv_line, file_stem
from clerestory.files import make_folder, write_text
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.rad_writer import format_rad
from clerestory.radiance.window_reader import read_windows
from clerestory.scene.material_parameters import with_parameters
from clerestory.scene.window import Window
from clerestory.study.config import Study
from clerestory.study.design_search import (
    Design,
    candidates,
    chosen_designs,
    inputs_of,
)
from clerestory.study.job import Display, Job
from clerestory.study.optimise_tables import OptimiseTable
from clerestory.study.study_files import window_text
from clerestory.study.study_run import MATRIX_FOLDER
from clerestory.study.variant_figures import RunFigures
from clerestory.study.variant_run import run_variants
from clerestory.study.variants import Variant

DESIGN_FOLDER, TABLE_FILE = "designs", "designs.csv"
AS_IT_IS = "as it is"


@dataclass(frozen=True, eq=False)
class Optimised:
    """Designs of the Pareto front, and their figures from full runs.

    `runs` starts with the study as it is; the others have the order of `designs`.
    """

    designs: tuple[Design, ...]
    runs: tuple[RunFigures, ...]
    table: OptimiseTable

    __repr__ = brief

    def met(self, number: int) -> bool:
        """Return whether a design is within all limits in its full run."""
        run = self.runs[number + 1]
        keys = [figure.key for figure in run.figures]
        for limit in self.table.limit:
            place = limit.place or next(p for n, p in keys if n == limit.figure)
            figure = run.of((limit.figure, place))
            assert figure is not None
            low = -np.inf if limit.least is None else limit.least
            high = np.inf if limit.most is None else limit.most
            if not low <= figure.value <= high:
                return False
        return True


def optimise_study(
    variants: Sequence[Variant], *, out: str | Path, display: Display | None = None
) -> Optimised:
    """Return the best designs of a study for its goals, each run in full.

    Parameters
    ----------
    variants : variants of a study with a table [optimise], as `read_variants` returns
        them: the discrete choices
    out : folder for the runs, `designs.csv` and the files of the designs
    display : function that starts a progress display, as for `run_study`

    Raises
    ------
    InputError : no table [optimise], a wrong name in it, or no design in its limits
    """
    out, display = make_folder(out), display or silent
    store, found = MatrixStore(out / MATRIX_FOLDER), []
    report = display("search")
    for number, variant in enumerate(variants):
        report(number / len(variants), variant.name)
        inputs = inputs_of(variant.study)
        job = Job(variant.study, inputs, store, display)
        assert variant.study.optimise is not None
        found.append(candidates(variant.name, job, variant.study.optimise))
    report(1.0, "done")
    first = variants[0].study
    assert first.optimise is not None
    designs = chosen_designs(found, first.optimise)
    made = [Variant(AS_IT_IS, first)]
    of = {variant.name: variant for variant in variants}
    for number, design in enumerate(designs, start=1):
        name = ", ".join(filter(None, (f"design {number}", design.variant)))
        folder = make_folder(out / DESIGN_FOLDER / file_stem(f"design{number}"))
        study = with_values(of[design.variant].study, design.values, folder)
        settings = {k: f"{v:.3g}" for k, v in design.values.items()}
        made.append(Variant(name, study, settings))
    runs = run_variants(made, out=out, display=display)
    result = Optimised(tuple(designs), tuple(runs), first.optimise)
    write_text(out / TABLE_FILE, designs_table(result))
    return result


def with_values(study: Study, values: Mapping[str, float], folder: Path) -> Study:
    """Return a study with other values of design variables, its files in a folder."""
    assert study.optimise is not None
    tables = {own.label: own for own in study.optimise.variable}
    materials = {
        tables[name].material: value
        for name, value in values.items()
        if tables[name].material
    }
    if materials:
        scene = with_parameters(read_rad(*study.scene.files), materials)
        file = folder / "scene.rad"
        write_text(file, format_rad(scene, bsdf_file={}) + "\n")
        table = study.scene.model_copy(update={"files": [file]})
        study = study.model_copy(update={"scene": table})
    shares = {
        tables[name].window: value
        for name, value in values.items()
        if tables[name].window
    }
    windows = []
    for window in study.window:
        share = shares.pop(window.label, None)
        if share is not None:
            file = folder / f"{file_stem(window.label)}.rad"
            write_text(file, reduced_windows(read_windows(window.file), share))
            window = window.model_copy(update={"file": file, "name": window.label})
        windows.append(window)
    for name in shares:
        known = ", ".join(window.label for window in study.window) or "none"
        raise InputError(f'window share of "{name}"; one of {known} expected')
    return study.model_copy(update={"window": windows})


def reduced_windows(windows: Sequence[Window], share: float) -> str:
    """Return windows of a share of their area, about the middle of each polygon."""
    require(0 < share <= 1, f"window share is {share:g}; above 0, at most 1, expected")
    texts = []
    for window in windows:
        basis = {145: "kf", 73: "kh", 77: "kh", 41: "kq"}.get(len(window.partition), "")
        require(basis, f'window "{window.name}" has no Klems basis; one expected')
        outlines = []
        for polygon in window.polygons:
            centre = polygon.vertices.mean(axis=0)
            outlines.append(centre + np.sqrt(share) * (polygon.vertices - centre))
        up = window.frame.up
        texts.append(window_text(window.name, outlines, basis=basis, up=up))
    return "\n".join(texts)


def designs_table(found: Optimised) -> str:
    """Return a CSV table: a line for each design and figure."""
    names = [own.label for own in found.table.variable]
    head = ["design", "variant", *names, "within limits", "figure", "place", "unit"]
    lines = [csv_line([*head, "expected", "run", "standard error of the run"])]
    for number, design in enumerate(found.designs):
        run = found.runs[number + 1]
        values = [f"{design.values[name]:.6g}" for name in names]
        met = "yes" if found.met(number) else "no"
        for key, expected in design.figures.items():
            figure = run.of(key)
            if figure is None:
                continue
            numbers = [f"{x:.6g}" for x in (expected, figure.value, figure.error)]
            words = [str(number + 1), design.variant, *values, met, *key, figure.unit]
            lines.append(csv_line([*words, *numbers]))
    return "\n".join(line.rstrip("\n") for line in lines) + "\n"
