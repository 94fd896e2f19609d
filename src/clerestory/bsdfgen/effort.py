"""How long to trace a BSDF, checked."""

from collections.abc import Callable
from dataclasses import dataclass

from clerestory.errors import InputError

Progress = Callable[[float, str], None]

# Used when neither samples nor an error is asked for: paths from an incident patch or
# cell, as many as genBSDF's.
DEFAULT_SAMPLES = 2000


@dataclass(frozen=True)
class TraceEffort:
    """How long to trace.

    Attributes
    ----------
    samples : paths from each incident patch, or from each finest incident cell of a
        tree on average; None to aim at an error
    relative_error : root mean square of the errors of all values to reach, relative to
        their mean
    bounces : most diffuse reflections or transmissions of a path; None: no limit
    seed : any whole number; the same seed gives the same result
    progress : called with the share done and a note

    Raises
    ------
    InputError : both samples and error given, or a number out of range
    """

    samples: int | None = None
    relative_error: float | None = None
    bounces: int | None = None
    seed: int = 0
    progress: Progress | None = None

    def __post_init__(self) -> None:
        samples, error = self.samples, self.relative_error
        if samples is not None and error is not None:
            raise InputError(
                "both samples and relative_error given; one of them expected"
            )
        if samples is None and error is None:
            object.__setattr__(self, "samples", DEFAULT_SAMPLES)
        if samples is not None and not 1 <= samples <= 1 << 26:
            raise InputError(
                f"samples = {samples}; a whole number from 1 to 2^26 expected"
            )
        if error is not None and not 1e-4 <= error < 10:
            raise InputError(f"relative_error = {error}; 0.0001 to 10 expected")
        if self.bounces is not None and self.bounces < 0:
            raise InputError(f"bounces = {self.bounces}; 0 or more expected")
        if not 0 <= self.seed < 1 << 32:
            raise InputError(
                f"seed = {self.seed}; a whole number from 0 to 2^32 - 1 expected"
            )
