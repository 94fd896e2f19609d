"""Sampling effort of a command from its options."""

from clerestory.cli.requests.common import EffortOptions
from clerestory.engine.effort import Effort
from clerestory.engine.work_units import Executor
from clerestory.progress import Progress


def effort_of(
    options: EffortOptions, executor: Executor, progress: Progress | None
) -> Effort:
    """Return the sampling effort set by options, with executor and progress report."""
    return Effort(
        samples=options.samples,
        relative_error=options.relative_error,
        bounces=options.bounces,
        seed=options.seed,
        device=options.device,
        executor=executor,
        progress=progress,
    )
