"""What run.json tells beyond the results: versions, machine, seconds, matrices."""

import platform
from collections.abc import Mapping, Sequence
from importlib.metadata import PackageNotFoundError, version
from typing import Any

import xarray as xr

from clerestory import __version__
from clerestory.engine.device import resolve
from clerestory.study.config import Study

_PACKAGES = ("mitsuba", "drjit", "numpy", "xarray", "pvlib")


def run_facts(
    study: Study,
    found: Mapping[str, bool],
    data: xr.Dataset,
    seconds: Mapping[str, float],
    warnings: Sequence[str],
) -> dict[str, Any]:
    """Return the facts about a run.

    Parameters
    ----------
    found : whether each matrix was found from an earlier run, by its file's name
    seconds : by phase
    """
    mean, error = data["mean_illuminance"], data["mean_illuminance_error"]
    relative = (error / mean.where(mean > 0)).groupby("grid").median()
    return {
        "title": study.title,
        "study": study.facts(),
        "versions": {"clerestory": __version__, **_versions()},
        "machine": f"{platform.system()} {platform.machine()}",
        "seed": study.trace.seed,
        "device": resolve(study.trace.device),
        "seconds": dict(seconds),
        "median_relative_error_of_mean": {
            str(grid): round(float(value), 5)
            for grid, value in zip(
                relative["grid"].values, relative.values, strict=True
            )
        },
        "matrices": {name: {"found": known} for name, known in found.items()},
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
