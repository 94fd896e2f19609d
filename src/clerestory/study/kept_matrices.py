"""Cached matrices of a study: read from the cache, or traced and stored."""

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
    """Return a matrix from the cache, or trace and store it.

    Parameters
    ----------
    trace : function of `effort` and `progress` that traces the matrix
    key : all inputs of the matrix except the effort
    shown : name of the matrix in the progress display
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
    """Return matrices that are traced together, by window name; see `kept`.

    Parameters
    ----------
    name : common prefix of the matrix names, followed by the window name
    """
    names = {f"{name}-{window.name}": window.name for window in windows}

    def make() -> dict[str, TransferMatrix]:
        traced = trace(effort=effort, progress=job.display(shown))
        return {name: traced[window] for name, window in names.items()}

    found = job.matrices(list(names), fingerprint(*key, effort), make)
    return {window: found[name] for name, window in names.items()}
