"""Effort of a Monte Carlo estimate: samples or error, path depth, seed, device.

An `Effort` is passed from the study file, the command line or Python to the engine.
Public functions accept `effort`, its fields as keywords, or both; keywords override
fields.
"""

import difflib
import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import TypedDict

from clerestory.checks import not_negative, require, within
from clerestory.engine.device import Device, Processor
from clerestory.engine.sums import BATCHES
from clerestory.engine.work_units import Executor, Goal, Local
from clerestory.errors import InputError
from clerestory.progress import Progress

_MOST_SAMPLES, _LEAST_ERROR, _MOST_ERROR = 1 << 26, 1e-5, 10.0


class JobOptions(TypedDict):
    """Fields of a job that are set by an `Effort`."""

    bounces: int | None
    seed: int
    batches: int
    device: Processor


@dataclass(frozen=True, kw_only=True)
class Effort:
    """Computational effort of an estimate: samples or error, path depth, seed, device.

    Attributes
    ----------
    samples : paths per row; None if a relative error is given
    relative_error : target relative standard error; see the tracing functions
    bounces : largest number of diffuse reflections, as Radiance's -ab; None: no limit
    seed : whole number ≥ 0; equal seeds on the same device give bitwise identical
        results
    device : "auto" selects a GPU if there is one
    executor : executor of work units, such as a `Cluster`; default: this process.
        Results are bitwise identical for all executors
    progress : callback that receives the fraction done, 0…1, and a note
    batches : number of independent estimates of each row; None: the default of the job
    components : whether the deviation of each batch from the mean is kept

    Raises
    ------
    InputError : both samples and relative_error are given, or a number is out of range
    """

    samples: int | None = None
    relative_error: float | None = None
    bounces: int | None = None
    seed: int = 0
    device: Device = "auto"
    executor: Executor = field(default_factory=Local)
    progress: Progress | None = None
    batches: int | None = None
    components: bool = True

    def __post_init__(self) -> None:
        require(
            self.samples is None or self.relative_error is None,
            "both samples and relative_error given; one of them expected",
        )
        _check_goal(self, _MOST_SAMPLES, _MOST_ERROR)
        if self.bounces is not None:
            not_negative(self.bounces, "bounces")
        require(
            0 <= self.seed < 1 << 32,
            f"seed is {self.seed}; a whole number from 0 to 2^32 - 1 expected",
        )
        if self.batches is not None:
            within(self.batches, "batches", least=2, most=1 << 10)

    @property
    def goal(self) -> Goal:
        """Stopping criterion: number of samples, or relative error."""
        return Goal(self.samples, self.relative_error)

    def job_options(self, batches: int = BATCHES) -> JobOptions:
        """Return the options of the effort that affect the sums of a job.

        `batches` is the default number of batches.
        """
        return JobOptions(
            bounces=self.bounces,
            seed=self.seed,
            batches=self.batches or batches,
            device=self.executor.resolve(self.device),
        )


class EffortKeywords(TypedDict, total=False):
    """Keywords of all tracing functions: an effort, and fields that override it."""

    effort: Effort
    samples: int | None
    relative_error: float | None
    bounces: int | None
    seed: int
    device: Device
    executor: Executor | None
    progress: Progress | None
    batches: int | None
    components: bool


def effort_of(
    function: Callable[..., object],
    keywords: EffortKeywords,
    *,
    default: Goal,
    most_samples: int = _MOST_SAMPLES,
    most_error: float = 1.0,
    without: Collection[str] = (),
) -> Effort:
    """Return the effort given by the keywords of a public function.

    The default applies if neither samples nor an error is given; `without` names fields
    that do not apply to the function.
    """
    given: Mapping[str, object] = {**keywords}
    names = [each.name for each in fields(Effort) if each.name not in without]
    unknown = [name for name in given if name not in ("effort", *names)]
    if unknown:
        raise InputError(_unknown_keyword(function, unknown[0], names))
    changed = {name: value for name, value in given.items() if name != "effort"}
    if changed.get("executor", True) is None:
        del changed["executor"]
    # Use a new executor for each call, unless the caller passes one
    base = keywords.get("effort") or Effort()
    effort = replace(base, **changed)  # type: ignore[arg-type]
    for name in without:
        plain = getattr(effort, name) == getattr(Effort(), name)
        require(plain, f"{name} is set, but {function.__name__}() does not use it")
    if effort.samples is None and effort.relative_error is None:
        return replace(
            effort, samples=default.samples, relative_error=default.relative_error
        )
    _check_goal(effort, most_samples, most_error)
    return effort


def _unknown_keyword(
    function: Callable[..., object], name: str, names: list[str]
) -> str:
    parameters = inspect.signature(function).parameters.values()
    own = [each.name for each in parameters if each.kind is each.KEYWORD_ONLY]
    known = [*own, *names, "effort"]
    [closest] = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    return (
        f"{function.__name__}() takes no keyword {name!r}; {closest!r} is the closest"
        f" of {', '.join(known)}"
    )


def _check_goal(effort: Effort, most_samples: int, most_error: float) -> None:
    samples, error = effort.samples, effort.relative_error
    power = most_samples.bit_length() - 1
    require(
        samples is None or 1 <= samples <= most_samples,
        f"samples is {samples}; a whole number from 1 to 2^{power} expected",
    )
    require(
        error is None or _LEAST_ERROR <= error < most_error,
        f"relative_error is {error}; 0.00001 to below {most_error:g} expected",
    )
