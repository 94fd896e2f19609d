"""Matrices, skies and operated shades of a study, without its results."""

from collections.abc import Sequence

import numpy as np

from clerestory.errors import InputError
from clerestory.phases.matrix_equation import States
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.job import Job
from clerestory.study.retracing import Situation
from clerestory.study.shade_operation import operate
from clerestory.study.study_skies import study_skies
from clerestory.study.study_tracing import trace_study


def operated(job: Job) -> Situation:
    """Return the matrices, skies and shade states of a study.

    Raises
    ------
    InputError : a control rule depends on glare
    """
    matrices = trace_study(job)
    skies = study_skies(job.study, job.inputs, matrices.suns, recent=job.recent)
    signals = ControlInputs(
        job.study, job.inputs, matrices, skies, _no_glare, _no_grid_glare
    )
    return Situation(matrices, skies, operate(signals).states)


def _no_glare(states: States, steps: np.ndarray, names: Sequence[str]) -> np.ndarray:
    message = "a control rule depends on glare; shades operated by light or sun"
    raise InputError(f"{message} expected")


def _no_grid_glare(
    states: States, steps: np.ndarray, names: Sequence[str], *, enough: float
) -> np.ndarray:
    return _no_glare(states, steps, names)
