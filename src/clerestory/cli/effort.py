"""Sampling effort of a command from its options, with executor and progress display."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager

from clerestory.cli.progress import progress_display
from clerestory.cli.requests.common import EffortOptions, SunEffort
from clerestory.cluster.cluster import executor_at
from clerestory.engine.effort import Effort


@contextmanager
def tracing(
    options: EffortOptions | SunEffort, *, quiet: bool
) -> Iterator[Callable[[str], Effort]]:
    """Yield a function that returns the sampling effort of a job, given its title."""
    given = dict(vars(options))
    with (
        executor_at(given.pop("cluster")) as executor,
        progress_display(quiet=quiet) as display,
    ):
        yield lambda title: Effort(executor=executor, progress=display(title), **given)
