"""Facts of a run for run.json: study, input files, versions, times, matrices."""

import platform
from collections.abc import Mapping
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import xarray as xr

from clerestory import __version__
from clerestory.study.job import Job
from clerestory.study.run_log import RunLog

# Packages whose versions are recorded in run.json
_PACKAGES = ("mitsuba", "drjit", "numpy", "xarray", "pvlib")


def run_facts(
    job: Job, files: Mapping[str, str], data: xr.Dataset, log: RunLog
) -> dict[str, Any]:
    """Return the content of run.json: what a run was made of, and what it took.

    `files` are hashes of the content of the input files, by path.
    """
    mean, error = data["mean_illuminance"], data["mean_illuminance_error"]
    relative = (error / mean.where(mean > 0)).groupby("grid").median()
    return {
        "title": job.study.title,
        "study": job.study.facts(),
        "files": dict(files),
        "versions": {"clerestory": __version__, **_versions()},
        "machine": f"{platform.system()} {platform.machine()}",
        "seed": job.study.trace.seed,
        "device": job.device,
        "seconds": log.seconds,
        "median_relative_error_of_mean": {
            str(grid): round(error, 5) for grid, error in relative.to_series().items()
        },
        "matrices": {name: {"found": known} for name, known in job.found.items()},
        "warnings": list(log.warnings.lines()),
    }


def _versions() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found
