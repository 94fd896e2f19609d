"""Dry run: estimate of time, memory and disk space of a run.

A dry run has the same stages as a run, with an executor that records the tracing jobs
instead of executing them. Matrices in the cache have no cost.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from clerestory.cluster.cluster import executor_at
from clerestory.engine.cost_estimate import JobCost, Plan, estimate_costs
from clerestory.matrix.error_components import COUNT
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_store import MatrixStore, block_names
from clerestory.phases.stored_views import FEW
from clerestory.progress import silent
from clerestory.scene.model import Polygon, Scene, TriangleMesh
from clerestory.study.annual_views import warn_of_views
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs, read_inputs
from clerestory.study.job import Job
from clerestory.study.luminaire_matrices import trace_lamps
from clerestory.study.study_run import MATRIX_FOLDER
from clerestory.study.study_tracing import needs_direct, trace_study
from clerestory.study.view_matrices import trace_views

# Memory besides that of matrices [bytes]: libraries and compiled kernels; largest
# memory of the accumulators for one block of matrix rows
_PROCESS, _SUMS = 450e6, 5 * 2**29

# Approximate memory per triangle [bytes], in main and GPU memory
_TRIANGLE = 400

# Bytes per value in a text table
_TEXT = 7


@dataclass(frozen=True)
class PlannedMatrix:
    """Size and tracing cost of a matrix; `kept` if the matrix is in the cache.

    Matrices traced together have the same number of ray paths; the first has the
    tracing time of all, the others 0 s. A `stored` matrix is never wholly in memory.
    """

    file: str
    kept: bool
    rows: int
    columns: int
    bytes: int
    paths: int
    seconds: float
    stored: bool = False


@dataclass(frozen=True)
class StudyPlan:
    """Estimated cost of a run; sizes in bytes.

    `later` is the cost of direct-sun coefficients traced for pictures, `streamed` the
    memory for the window radiance of all time steps if hourly results are in files.
    """

    device: str
    workers: int
    matrices: tuple[PlannedMatrix, ...]
    later: JobCost
    results: int
    scene: int
    streamed: int = 0

    @property
    def seconds(self) -> float:
        """Total tracing time of matrices that are not in the cache [s]."""
        return float(sum(m.seconds for m in self.matrices) + self.later.seconds)

    @property
    def memory(self) -> float:
        """Peak memory of the run [bytes]."""
        held = sum(m.bytes for m in self.matrices if not m.stored)
        sums = max(
            (m.bytes * (32 if m.stored else 6) for m in self.matrices), default=0
        )
        sums = min(_SUMS, sums)
        # The accumulators are freed before window radiance is allocated; they exist at
        # the same time as hourly results in memory
        work = max(sums, self.streamed) if self.streamed else sums + self.results
        return _PROCESS + held + self.scene + work

    @property
    def disk(self) -> int:
        """Disk space for new matrices and results [bytes]."""
        return self.results + sum(m.bytes for m in self.matrices if not m.kept)


@dataclass(frozen=True, eq=False)
class _Entry:
    # Matrices traced together, the fraction of their rows in the cache, and the indices
    # of the recorded tracing jobs
    files: tuple[str, ...]
    kept: float
    matrices: tuple[TransferMatrix, ...]
    jobs: range
    stored: bool = False


@dataclass(frozen=True, eq=False)
class PlannedStore:
    """Cache for dry runs: records requests, without reading or writing matrices."""

    store: MatrixStore
    plan: Plan
    entries: list[_Entry] = field(default_factory=list)

    def path(self, name: str, fingerprint: str) -> Path:
        """Return the path of a matrix file."""
        return self.store.path(name, fingerprint)

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether the matrix is in the cache."""
        return self.store.holds(name, fingerprint)

    def matrices(
        self,
        names: Sequence[str],
        fingerprint: str,
        make: Callable[[], Mapping[str, TransferMatrix]],
    ) -> dict[str, TransferMatrix]:
        """Record the requested matrices; return blank matrices of their shape."""
        first = len(self.plan.planned)
        made = dict(make())
        files = tuple(self.path(name, fingerprint).name for name in names)
        kept = float(all(self.holds(name, fingerprint) for name in names))
        matrices = tuple(made[name] for name in names)
        self._record(_Entry(files, kept, matrices, range(first, first)))
        return made

    def blocks(
        self,
        name: str,
        fingerprint: str,
        rows: Sequence[slice],
        make: Callable[[slice], TransferMatrix],
    ) -> tuple[Path, ...]:
        """Record a matrix traced in blocks, and the fraction of rows in the cache."""
        first, whole = len(self.plan.planned), rows[-1].stop
        matrix = make(slice(0, whole))
        parts = zip(block_names(name, len(rows)), rows, strict=True)
        kept = sum(r.stop - r.start for n, r in parts if self.holds(n, fingerprint))
        file, jobs = self.path(name, fingerprint).name, range(first, first)
        self._record(_Entry((file,), kept / whole, (matrix,), jobs, stored=True))
        return ()

    def _record(self, entry: _Entry) -> None:
        # Discard the tracing jobs of matrices in the cache or recorded before
        planned, first = self.plan.planned, entry.jobs.start
        twice = any(entry.files == other.files for other in self.entries)
        if entry.kept == 1 or twice:
            del planned[first:]
        if not twice:
            self.entries.append(replace(entry, jobs=range(first, len(planned))))


def plan_study(study: Study, *, out: str | Path) -> StudyPlan:
    """Estimate the cost of a run of a study.

    Each kind of matrix is traced for about one second to measure the speed. Matrices
    in the folder `out` are reused.
    """
    with executor_at(study.trace.cluster) as place:
        plan = Plan(place)
        store = PlannedStore(MatrixStore(Path(out) / MATRIX_FOLDER), plan)
        for method in study.methods:
            inputs = _walk_through(study.with_method(method), store, plan)
        return _planned(study, inputs, store, estimate_costs(plan))


def _walk_through(study: Study, store: PlannedStore, plan: Plan) -> Inputs:
    # Request the matrices that a run would request
    inputs = read_inputs(study)
    warn_of_views(study.view, inputs.cameras)
    job = Job(study, inputs, store, silent, executor=plan)
    for view in trace_views(job, trace_study(job)):
        for number, group in enumerate(inputs.groups if view.matrices.suns else ()):
            for state in range(len(group.states)):
                view.sun(number, state)
    trace_lamps(job)
    return inputs


def _planned(
    study: Study, inputs: Inputs, store: PlannedStore, foreseen: Sequence[JobCost]
) -> StudyPlan:
    found, place = [], store.plan.place
    for entry in store.entries:
        cost = _together([foreseen[number] for number in entry.jobs])
        left = 1 - entry.kept
        cost = JobCost(round(cost.paths * left), cost.seconds * left)
        for file, matrix in zip(entry.files, entry.matrices, strict=True):
            found.append(_matrix(file, matrix, cost, entry))
            cost = JobCost(cost.paths, 0.0)
    within = {number for entry in store.entries for number in entry.jobs}
    later = [each for n, each in enumerate(foreseen) if n not in within]
    steps = len(inputs.weather.times)
    return StudyPlan(
        device=place.resolve(study.trace.device),
        workers=place.workers(),
        matrices=tuple(found),
        later=_together(later),
        results=_hour_bytes(study) * len(inputs.sensors()) * steps,
        scene=_TRIANGLE * _triangles(inputs.scene),
        streamed=max((_leaving(e, steps) for e in store.entries), default=0),
    )


def _hour_bytes(study: Study) -> int:
    # Bytes per sensor and time step: illuminance, terms, sun, luminaires, text, and
    # errors with their components
    variables = 2 + COUNT // 4 + bool(study.lighting)
    if needs_direct(study):
        variables += 2 + COUNT // 4 + 3 * study.corrected
    return 4 * variables + _TEXT * (study.output.csv + study.output.ill)


def _leaving(entry: _Entry, steps: int) -> int:
    # Bytes of window radiance and its error components in the daylit half of the time
    if not entry.stored:
        return 0
    channels, _, patches = entry.matrices[0].values.shape
    return int(4 * channels * patches * (2 * FEW + 1) * steps // 2)


def _together(parts: Sequence[JobCost]) -> JobCost:
    return JobCost(sum(p.paths for p in parts), sum(p.seconds for p in parts))


def _matrix(
    file: str, matrix: TransferMatrix, cost: JobCost, entry: _Entry
) -> PlannedMatrix:
    parts = (matrix.values, matrix.components)
    return PlannedMatrix(
        file,
        entry.kept == 1,
        matrix.rows.size,
        matrix.columns.size,
        sum(part.nbytes for part in parts if part is not None),
        cost.paths,
        cost.seconds,
        entry.stored,
    )


def _triangles(scene: Scene) -> int:
    # Number of triangles, counting 100 for each curved surface
    return sum(
        len(surface.faces)
        if isinstance(surface, TriangleMesh)
        else len(surface.vertices) - 2
        if isinstance(surface, Polygon)
        else 100
        for surface in scene.surfaces
    )
