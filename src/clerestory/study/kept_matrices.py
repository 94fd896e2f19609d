"""Matrices of a study, traced or found again from an earlier run."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.scene.window import Window
from clerestory.study.job import Job


def kept(
    job: Job,
    name: str,
    trace: Callable[..., TransferMatrix],
    key: Sequence[Any],
    options: Mapping[str, Any],
    *,
    shown: str,
) -> TransferMatrix:
    """Return a matrix of an earlier run, or trace and keep it.

    Parameters
    ----------
    trace : takes the options, `executor` and `progress`
    key : all that the matrix depends on beside the options
    shown : what the display calls it
    """

    def make() -> TransferMatrix:
        progress = job.display(shown)
        return trace(executor=job.executor, progress=progress, **options)

    return job.matrix(name, fingerprint(*key, options), make)


def kept_together(
    job: Job,
    name: str,
    windows: Sequence[Window],
    trace: Callable[..., Mapping[str, TransferMatrix]],
    key: Sequence[Any],
    options: Mapping[str, Any],
    *,
    shown: str,
) -> dict[str, TransferMatrix]:
    """Return matrices that are traced at once, by the name of their window; see `kept`.

    Parameters
    ----------
    name : of the matrices; the name of the window follows
    """
    names = {f"{name}-{window.name}": window.name for window in windows}

    def make() -> dict[str, TransferMatrix]:
        progress = job.display(shown)
        traced = trace(executor=job.executor, progress=progress, **options)
        return {name: traced[window] for name, window in names.items()}

    found = job.matrices(list(names), fingerprint(*key, options), make)
    return {window: found[name] for name, window in names.items()}
