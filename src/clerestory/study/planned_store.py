"""Cache of matrices for dry runs: it records what a run would trace."""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from clerestory.engine.cost_estimate import Plan
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_store import BlockMaker, Maker, MatrixStore, block_names


@dataclass(frozen=True, eq=False)
class PlannedEntry:
    """Matrices traced together, and the indices of the recorded tracing jobs.

    `kept` is the fraction of their rows in the cache.
    """

    files: tuple[str, ...]
    kept: float
    matrices: tuple[TransferMatrix, ...]
    jobs: range
    stored: bool = False


@dataclass(frozen=True, eq=False)
class PlannedStore:
    """Cache for dry runs: records requests, without reading or writing matrices.

    `repeated` tells how often recorded jobs are traced, by their indices.
    """

    store: MatrixStore
    plan: Plan
    entries: list[PlannedEntry] = field(default_factory=list)
    repeated: dict[range, int] = field(default_factory=dict)

    def path(self, name: str, fingerprint: str) -> Path:
        """Return the path of a matrix file."""
        return self.store.path(name, fingerprint)

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether the matrix is in the cache."""
        return self.store.holds(name, fingerprint)

    def matrices(
        self, names: Sequence[str], fingerprint: str, make: Maker
    ) -> dict[str, TransferMatrix]:
        """Record the requested matrices; return blank matrices of their shape."""
        first = len(self.plan.planned)
        made = dict(make())
        files = tuple(self.path(name, fingerprint).name for name in names)
        kept = float(all(self.holds(name, fingerprint) for name in names))
        matrices = tuple(made[name] for name in names)
        self._record(PlannedEntry(files, kept, matrices, range(first, first)))
        return made

    def blocks(
        self, name: str, fingerprint: str, rows: Sequence[slice], make: BlockMaker
    ) -> tuple[Path, ...]:
        """Record a matrix traced in blocks, and the fraction of rows in the cache."""
        first, whole = len(self.plan.planned), rows[-1].stop
        matrix = make(slice(0, whole))
        parts = zip(block_names(name, len(rows)), rows, strict=True)
        kept = sum(r.stop - r.start for n, r in parts if self.holds(n, fingerprint))
        file, jobs = self.path(name, fingerprint).name, range(first, first)
        self._record(PlannedEntry((file,), kept / whole, (matrix,), jobs, stored=True))
        return ()

    def _record(self, entry: PlannedEntry) -> None:
        # Discard the tracing jobs of matrices in the cache or recorded before
        planned, first = self.plan.planned, entry.jobs.start
        twice = any(entry.files == other.files for other in self.entries)
        if entry.kept == 1 or twice:
            del planned[first:]
        if not twice:
            self.entries.append(replace(entry, jobs=range(first, len(planned))))
