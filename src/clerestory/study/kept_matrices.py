"""Matrices of a study, traced or found again from an earlier run."""

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from clerestory.engine.effort import Effort
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.scene.window import Window
from clerestory.study.job import Job


def kept(
    job: Job,
    name: str,
    trace: Callable[..., TransferMatrix],
    key: Sequence[Any],
    effort: Effort,
    *,
    shown: str,
) -> TransferMatrix:
    """Return a matrix of an earlier run, or trace and keep it.

    Parameters
    ----------
    trace : takes `effort` and `progress`
    key : all that the matrix depends on beside the effort
    shown : what the display calls it
    """

    def make() -> TransferMatrix:
        return trace(effort=effort, progress=job.display(shown))

    return job.matrix(name, fingerprint(*key, effort), make)


def kept_together(
    job: Job,
    name: str,
    windows: Sequence[Window],
    trace: Callable[..., Mapping[str, TransferMatrix]],
    key: Sequence[Any],
    effort: Effort,
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
        traced = trace(effort=effort, progress=job.display(shown))
        return {name: traced[window] for name, window in names.items()}

    found = job.matrices(list(names), fingerprint(*key, effort), make)
    return {window: found[name] for name, window in names.items()}
