"""Content of run.json: versions, machine, run times, matrices, warnings."""

import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import xarray as xr

from clerestory import __version__
from clerestory.study.job import Job

_PACKAGES = ("mitsuba", "drjit", "numpy", "xarray", "pvlib")


def run_facts(
    job: Job,
    data: xr.Dataset,
    seconds: Mapping[str, float],
    warnings: Sequence[str],
) -> dict[str, Any]:
    """Return the content of run.json; `seconds` are the run times of the phases."""
    mean, error = data["mean_illuminance"], data["mean_illuminance_error"]
    relative = (error / mean.where(mean > 0)).groupby("grid").median()
    return {
        "title": job.study.title,
        "study": job.study.facts(),
        "versions": {"clerestory": __version__, **_versions()},
        "machine": f"{platform.system()} {platform.machine()}",
        "seed": job.study.trace.seed,
        "device": job.device,
        "seconds": dict(seconds),
        "median_relative_error_of_mean": {
            str(grid): round(error, 5) for grid, error in relative.to_series().items()
        },
        "matrices": {name: {"found": known} for name, known in job.found.items()},
        "warnings": list(warnings),
    }


def _versions() -> dict[str, str]:
    found = {"python": platform.python_version()}
    for package in _PACKAGES:
        try:
            found[package] = version(package)
        except PackageNotFoundError:
            found[package] = "not installed"
    return found
