"""Durations of the stages of a run, and its warnings."""

import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from time import perf_counter

from clerestory.errors import ClerestoryWarning
from clerestory.warning_log import WarningLog


@dataclass
class RunLog:
    """Duration of each stage of a run [s], and warnings of the run by kind."""

    seconds: dict[str, float] = field(default_factory=dict)
    warnings: WarningLog = field(default_factory=WarningLog)

    @contextmanager
    def phase(self, name: str) -> Iterator[None]:
        """Measure the duration of a stage; record warnings, issue each kind once."""
        start, caught = perf_counter(), []
        try:
            with warnings.catch_warnings(record=True) as caught:
                warnings.simplefilter("always", ClerestoryWarning)
                yield
        finally:
            spent = self.seconds.get(name, 0.0) + perf_counter() - start
            self.seconds[name] = round(spent, 3)
            for item in caught:
                ours = issubclass(item.category, ClerestoryWarning)
                if not ours or self.warnings.add(str(item.message)):
                    warnings.warn_explicit(
                        item.message, item.category, item.filename, item.lineno
                    )
