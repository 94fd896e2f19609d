"""Effort of a Monte Carlo estimate: samples or error, path depth, seed, device.

One value, passed from the study file, the command line and Python down to the engine.
The public functions take it as `effort`, its fields as keywords, or both: keywords
replace fields.
"""

import difflib
import inspect
from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field, fields, replace
from typing import Literal, TypedDict

from clerestory.engine.device import Device
from clerestory.engine.sums import BATCHES
from clerestory.engine.work_units import Executor, Goal, Local
from clerestory.errors import InputError
from clerestory.progress import Progress

_MOST_SAMPLES, _LEAST_ERROR, _MOST_ERROR = 1 << 26, 1e-5, 10.0


class JobOptions(TypedDict):
    """Fields of a job that come from an effort."""

    bounces: int | None
    seed: int
    batches: int
    device: Literal["cpu", "cuda"]


@dataclass(frozen=True, kw_only=True)
class Effort:
    """How long to trace, where, and with which random numbers.

    Attributes
    ----------
    samples : paths per row; None to aim at an error
    relative_error : standard error to reach, relative; see the tracing functions
    bounces : most diffuse reflections or gathers, as Radiance's -ab; None: no limit
    seed : whole number ≥ 0; the same seed on the same device gives bitwise the same
        result
    device : "auto" takes a GPU if there is one
    executor : where the work is done, such as a `Cluster`; this process by default.
        It changes no bit of the result
    progress : called with the share done, 0…1, and a note
    batches : independent estimates of each row; None: as many as the quantity needs
    components : whether the batches' deviations are kept, as error components

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range
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
        samples, error = self.samples, self.relative_error
        if samples is not None and error is not None:
            raise InputError(
                "both samples and relative_error given; one of them expected"
            )
        if samples is not None:
            _check_samples(samples, _MOST_SAMPLES)
        if error is not None:
            _check_error(error, _MOST_ERROR)
        if self.bounces is not None and self.bounces < 0:
            raise InputError(f"bounces = {self.bounces}; 0 or more expected")
        if not 0 <= self.seed < 1 << 32:
            raise InputError(
                f"seed = {self.seed}; a whole number from 0 to 2^32 - 1 expected"
            )
        if self.batches is not None and not 2 <= self.batches <= 1 << 10:
            raise InputError(f"batches = {self.batches}; 2 to 1024 expected")

    @property
    def goal(self) -> Goal:
        """When the work is done."""
        return Goal(self.samples, self.relative_error)

    def job_options(self, batches: int = BATCHES) -> JobOptions:
        """Return the part of the effort that the sums of a job depend on.

        Parameters
        ----------
        batches : used where the effort asks for none
        """
        return JobOptions(
            bounces=self.bounces,
            seed=self.seed,
            batches=self.batches or batches,
            device=self.executor.resolve(self.device),
        )


_PLAIN = Effort()


class EffortKeywords(TypedDict, total=False):
    """Keywords of all functions that trace: an effort, and fields that replace its."""

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
    """Return the effort that the keywords of a public function ask for.

    Parameters
    ----------
    function : that was called, for messages
    keywords : `effort` or fields of `Effort`
    default : used when neither samples nor an error is asked for
    most_samples, most_error : limits of the function
    without : fields that have no meaning for the function

    Raises
    ------
    InputError : an unknown keyword, samples and relative_error both given, or a number
        out of range
    """
    given: Mapping[str, object] = {**keywords}
    names = [each.name for each in fields(Effort) if each.name not in without]
    unknown = [name for name in given if name not in ("effort", *names)]
    if unknown:
        raise InputError(_unknown_keyword(function, unknown[0], names))
    changed = {name: value for name, value in given.items() if name != "effort"}
    if changed.get("executor", True) is None:
        del changed["executor"]
    # An executor of its own for each call, unless the caller keeps one
    base = keywords.get("effort") or Effort()
    effort = replace(base, **changed)  # type: ignore[arg-type]
    for name in without:
        if getattr(effort, name) != getattr(_PLAIN, name):
            raise InputError(f"{function.__name__}() takes no {name}; none expected")
    if effort.samples is None and effort.relative_error is None:
        return replace(
            effort, samples=default.samples, relative_error=default.relative_error
        )
    if effort.samples is not None:
        _check_samples(effort.samples, most_samples)
    if effort.relative_error is not None:
        _check_error(effort.relative_error, most_error)
    return effort


def _unknown_keyword(
    function: Callable[..., object], name: str, names: list[str]
) -> str:
    own = [
        each.name
        for each in inspect.signature(function).parameters.values()
        if each.kind is each.KEYWORD_ONLY
    ]
    known = [*own, *names, "effort"]
    closest = difflib.get_close_matches(name, known, n=1, cutoff=0.0)
    return (
        f"{function.__name__}() takes no keyword {name!r}; {closest[0]!r} is the"
        f" closest of {', '.join(known)}"
    )


def _check_samples(samples: int, most: int) -> None:
    if not 1 <= samples <= most:
        power = most.bit_length() - 1
        raise InputError(
            f"samples = {samples}; a whole number from 1 to 2^{power} expected"
        )


def _check_error(error: float, most: float) -> None:
    if not _LEAST_ERROR <= error < most:
        raise InputError(f"relative_error = {error}; 0.00001 to {most:g} expected")
