"""Run of all variants of a study.

Everything that variants have in common is computed once: matrices are traced under one
key and read once, and scenes, layers, weather, skies and the products D S stay in
memory. A restarted run continues with the first variant that is not complete.
"""

import json
from collections.abc import Sequence
from pathlib import Path

from clerestory import __version__
from clerestory.cluster.cluster import executor_at
from clerestory.documents import json_value
from clerestory.engine.work_units import Executor
from clerestory.errors import InputError
from clerestory.escaping import file_stems
from clerestory.file_lock import locked
from clerestory.files import make_folder, read_text, write_text
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_store import MatrixStore, SharedStore
from clerestory.phases.recent_values import RecentValues
from clerestory.progress import silent
from clerestory.radiance.rad_reader import read_rad
from clerestory.study.config import Study
from clerestory.study.input_files import content_hashes
from clerestory.study.job import Display
from clerestory.study.method_comparison import compare_methods
from clerestory.study.method_run import run_method
from clerestory.study.results import RESULTS_FILE, Results, read_results
from clerestory.study.study_run import LOCK_FILE, MATRIX_FOLDER
from clerestory.study.variant_figures import RunFigures, run_figures
from clerestory.study.variant_outputs import write_variants
from clerestory.study.variants import Variant
from clerestory.threads import linear_algebra_in_one_thread

# Names of files in the results folder: what each finished variant was computed from
FINISHED_FILE = "finished.json"

# Share of the memory of a study for values that variants have in common
_SHARED = 0.5


def run_variants(
    variants: Sequence[Variant], *, out: str | Path, display: Display | None = None
) -> list[RunFigures]:
    """Run all variants of a study, and write their results into a folder.

    Parameters
    ----------
    variants : variants, as returned by `read_variants`
    out : folder for the tables of all variants and `matrices/`, created if missing;
        the results of each variant are in a folder named after it
    display : function that starts a progress display, as for `run_study`

    Returns
    -------
    figures of merit of each variant

    Raises
    ------
    InputError, DeviceError, OutputError : as for `run_study`
    """
    out, display = make_folder(out), display or silent
    trace = variants[0].study.trace
    recent = RecentValues(_SHARED * 1e9 * max(trace.memory_gb, 1.0))
    store = SharedStore(MatrixStore(out / MATRIX_FOLDER), recent)
    folders = variant_folders(variants, out)
    report, found = display("variants"), []
    lock = locked(out, lock=out / LOCK_FILE)
    # Products of variants are small: threads of the linear algebra would wait
    one_thread = linear_algebra_in_one_thread()
    with lock, one_thread, executor_at(trace.cluster) as executor:
        finished = _finished(out)
        for number, variant in enumerate(variants):
            report(
                number / len(variants), f"{number} of {len(variants)}: {variant.name}"
            )
            folder, key = folders[variant.name], _input_key(variant.study)
            if key and finished.get(variant.name) == key and _is_complete(folder):
                results = read_results(folder)
            else:
                results = _run(variant, folder, store, executor, display, recent)
                finished[variant.name] = key
                write_text(out / FINISHED_FILE, json.dumps(finished, indent=1) + "\n")
            own = run_figures(results, name=variant.name, settings=variant.settings)
            found.append(own)
            results.data.close()
        report(1.0, "done")
        if len(found) > 1:
            write_variants(found, out)
    return found


def variant_folders(variants: Sequence[Variant], out: Path) -> dict[str, Path]:
    """Return the results folder of each variant, by name."""
    names = (variant.name for variant in variants)
    stems = file_stems(names, taken={MATRIX_FOLDER})
    return {name: out / stem for name, stem in stems.items()}


def _run(
    variant: Variant,
    folder: Path,
    store: SharedStore,
    executor: Executor,
    display: Display,
    recent: RecentValues,
) -> Results:
    study = variant.study
    title = f"{study.title}: {variant.name}" if variant.name else study.title
    study = study.model_copy(update={"title": title})
    run = compare_methods if len(study.methods) > 1 else run_method
    return run(
        study,
        out=make_folder(folder),
        store=store,
        executor=executor,
        display=lambda name: display(f"{variant.name}: {name}"),
        recent=recent,
    )


def _input_key(study: Study) -> str:
    # Hash of the study and the content of its input files; "" if it is not known
    if any(each.control and each.control.rule == "python" for each in study.window):
        return ""
    files = list(content_hashes(study).values())
    # Scene files may name other files: the scene is hashed as it is read
    scene = fingerprint(read_rad(*study.scene.files))
    return fingerprint(__version__, study.to_json(), files, scene)


def _finished(out: Path) -> dict[str, str]:
    # What each finished variant was computed from, by name
    file = out / FINISHED_FILE
    if not file.is_file():
        return {}
    try:
        found = json_value(read_text(file), file=file)
    except InputError:
        return {}
    known = found.items() if isinstance(found, dict) else ()
    return {str(name): str(key) for name, key in known if key}


def _is_complete(folder: Path) -> bool:
    return (folder / RESULTS_FILE).is_file()
