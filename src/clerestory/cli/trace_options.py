"""Options of the commands that trace matrices, as one value.

Typer reads options from the signature of a command. A command that takes them as one
value is registered `spelt_out`: its signature then names each of them.
"""

import functools
import inspect
from collections.abc import Callable
from dataclasses import dataclass, fields

from clerestory.cli.options import (
    Bounces,
    ClusterAddress,
    DeviceOption,
    Format,
    Quiet,
    RelativeError,
    Samples,
    Seed,
)
from clerestory.engine.effort import Effort
from clerestory.engine.work_units import Executor
from clerestory.progress import Progress


@dataclass(frozen=True)
class TraceOptions:
    """How long to trace, where, and how to tell of it; each field is an option."""

    samples: Samples = None
    relative_error: RelativeError = None
    bounces: Bounces = None
    seed: Seed = 1
    device: DeviceOption = "auto"
    cluster: ClusterAddress = None
    encoding: Format = "float"
    quiet: Quiet = False

    def effort(self, executor: Executor, progress: Progress | None) -> Effort:
        """Return the effort that the options ask for."""
        return Effort(
            samples=self.samples,
            relative_error=self.relative_error,
            bounces=self.bounces,
            seed=self.seed,
            device=self.device,
            executor=executor,
            progress=progress,
        )


def spelt_out(command: Callable[..., None]) -> Callable[..., None]:
    """Return a command that takes each option by itself, in place of `options`.

    Examples
    --------
    >>> def sun(place: str, *, options: TraceOptions) -> None:
    ...     print(place, options.samples, options.seed)
    >>> spelt_out(sun)(place="Oslo", samples=64)
    Oslo 64 1
    >>> list(inspect.signature(spelt_out(sun)).parameters)[:3]
    ['place', 'samples', 'relative_error']
    """
    signature = inspect.signature(command)
    own = [p for p in signature.parameters.values() if p.name != "options"]
    names = [field.name for field in fields(TraceOptions)]

    @functools.wraps(command)
    def called(**given: object) -> None:
        chosen = {name: given.pop(name) for name in names if name in given}
        command(**given, options=TraceOptions(**chosen))  # type: ignore[arg-type]

    spelt = [
        inspect.Parameter(
            field.name,
            inspect.Parameter.KEYWORD_ONLY,
            default=field.default,
            annotation=field.type,
        )
        for field in fields(TraceOptions)
    ]
    parameters = [*own, *spelt]
    called.__signature__ = signature.replace(  # type: ignore[attr-defined]
        parameters=parameters
    )
    called.__annotations__ = {p.name: p.annotation for p in parameters}
    return called
