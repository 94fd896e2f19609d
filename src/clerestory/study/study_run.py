"""Run a study, by one method or by several."""

from pathlib import Path
from typing import Any

from clerestory.cluster.cluster import executor_at
from clerestory.files import make_folder
from clerestory.phases.matrix_store import MatrixStore
from clerestory.study.config import Study
from clerestory.study.job import Display
from clerestory.study.method_comparison import compare_methods
from clerestory.study.method_run import run_method
from clerestory.study.results import Results

MATRIX_FOLDER = "matrices"


def run_study(
    study: Study, *, out: str | Path, display: Display | None = None
) -> Results:
    """Run a study and write its results into a folder, made if need be.

    Parameters
    ----------
    study : from `read_study`
    out : gets `results.nc`, `run.json`, the tables asked for, and `matrices/`; where
        several methods are compared, a folder for each besides
    display : starts the display of a long phase, given its name; returns a callable
        (share done 0…1, note)

    Returns
    -------
    the results; where several methods are compared, those of the last one

    Raises
    ------
    InputError : a file of the study is wrong
    DeviceError : no usable compute device
    OutputError : the folder cannot be written
    """
    out, display = make_folder(out), display or _silent
    store = MatrixStore(out / MATRIX_FOLDER)
    run = compare_methods if len(study.methods) > 1 else run_method
    with executor_at(study.trace.cluster) as executor:
        return run(study, out=out, store=store, executor=executor, display=display)


def _silent(_phase: str) -> Any:
    return lambda _share, _note: None
