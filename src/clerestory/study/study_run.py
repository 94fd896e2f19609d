"""Run of a study with one or several phase methods."""

from pathlib import Path

from clerestory.cluster.cluster import executor_at
from clerestory.file_lock import locked
from clerestory.files import make_folder
from clerestory.phases.matrix_store import MatrixStore
from clerestory.progress import silent
from clerestory.study.config import Study
from clerestory.study.job import Display
from clerestory.study.method_comparison import compare_methods
from clerestory.study.method_run import run_method
from clerestory.study.results import Results

MATRIX_FOLDER = "matrices"
LOCK_FILE = "run.lock"


def run_study(
    study: Study, *, out: str | Path, display: Display | None = None
) -> Results:
    """Run a study and write its results into a folder, created if missing.

    Parameters
    ----------
    study : study, as returned by `read_study`
    out : folder for `results.nc`, `run.json`, tables and `matrices/`; with several
        methods, also a folder for each method
    display : function that starts the progress display of a phase, given its name, and
        returns a callback (completed fraction 0…1, status text)

    Returns
    -------
    results of the study, of the last method if there are several

    Raises
    ------
    InputError : a file of the study is invalid
    DeviceError : no usable compute device
    OutputError : the folder is not writable, or another run writes into it
    """
    out, display = make_folder(out), display or silent
    store = MatrixStore(out / MATRIX_FOLDER)
    run = compare_methods if len(study.methods) > 1 else run_method
    lock = locked(out, lock=out / LOCK_FILE)
    with lock, executor_at(study.trace.cluster) as executor:
        return run(study, out=out, store=store, executor=executor, display=display)
