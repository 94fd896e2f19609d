"""Options of effort as the keywords of functions that trace."""

from clerestory.cli.requests.common import EffortOptions
from clerestory.engine.work_units import Executor
from clerestory.phases.traced_matrices import Progress, Tracing


def tracing_keywords(
    effort: EffortOptions, executor: Executor, progress: Progress | None
) -> Tracing:
    """Return samples or error, bounces, seed and device with workers and progress."""
    return Tracing(
        samples=effort.samples,
        relative_error=effort.relative_error,
        bounces=effort.bounces,
        seed=effort.seed,
        device=effort.device,
        executor=executor,
        progress=progress,
    )
