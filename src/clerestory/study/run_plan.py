"""What a run will take, before it starts: matrices, time, memory, disk.

A plan walks through a study as a run does, with an executor that takes note of every
trace instead of doing it. Matrices of an earlier run are named and cost nothing.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from clerestory.cluster.cluster import executor_at
from clerestory.engine.cost_estimate import JobCost, Plan, estimate_costs
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_store import MatrixStore, block_names
from clerestory.phases.pooled import FEW
from clerestory.progress import Progress
from clerestory.scene.model import Polygon, Scene, TriangleMesh
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs, read_inputs
from clerestory.study.job import Job
from clerestory.study.luminaire_matrices import trace_lamps
from clerestory.study.study_run import MATRIX_FOLDER
from clerestory.study.study_tracing import needs_direct, trace_study
from clerestory.study.view_matrices import trace_views

# What a run holds beside matrices: libraries and kernels, and the sums of a block of
# rows with their means and deviations [bytes]
_PROCESS, _SUMS = 450e6, 5 * 2**29

# What a triangle takes on the device and on its way there [bytes], roughly
_TRIANGLE = 400

# Bytes of an hourly value in a table of text
_TEXT = 7


@dataclass(frozen=True)
class PlannedMatrix:
    """A matrix of a run.

    Attributes
    ----------
    file : that it is kept in
    kept : whether an earlier run left it there
    rows, columns : of the matrix
    bytes : that it takes on disk and in memory, without what labels it
    paths : to be traced for it and for those that are traced with it
    seconds : that this takes, 0 for what is traced along with another
    stored : whether it lies in files block by block, and is never held whole
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
    """What a run will take.

    Attributes
    ----------
    device : that it traces on, and how many workers there are
    matrices : in the order in which they are traced
    later : what is traced while pictures are made, by paths and seconds
    results : that are written besides [bytes]
    scene : what the scene takes in memory [bytes]
    streamed : what leaves the windows, held in place of hourly results where these
        lie in files [bytes]; else 0
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
        """Time to trace what is not kept [s]."""
        return float(sum(m.seconds for m in self.matrices) + self.later.seconds)

    @property
    def memory(self) -> float:
        """Most memory of the run [bytes]."""
        held = sum(m.bytes for m in self.matrices if not m.stored)
        sums = max(
            (m.bytes * (32 if m.stored else 6) for m in self.matrices), default=0
        )
        sums = min(_SUMS, sums)
        # What leaves the windows is there when sums are no more; hours are kept beside
        work = max(sums, self.streamed) if self.streamed else sums + self.results
        return _PROCESS + held + self.scene + work

    @property
    def disk(self) -> int:
        """What the run will write [bytes]."""
        return self.results + sum(m.bytes for m in self.matrices if not m.kept)


@dataclass(frozen=True, eq=False)
class _Entry:
    # Matrices that are traced together, the share of them that is kept, and the numbers
    # of the jobs noted for them
    files: tuple[str, ...]
    kept: float
    matrices: tuple[TransferMatrix, ...]
    jobs: range
    stored: bool = False


@dataclass(frozen=True, eq=False)
class PlannedStore:
    """A store that neither reads nor writes, but takes note of what it is asked for."""

    store: MatrixStore
    plan: Plan
    entries: list[_Entry] = field(default_factory=list)

    def path(self, name: str, fingerprint: str) -> Path:
        """File of a matrix."""
        return self.store.path(name, fingerprint)

    def holds(self, name: str, fingerprint: str) -> bool:
        """Whether an earlier run kept the matrix."""
        return self.store.holds(name, fingerprint)

    def matrices(
        self,
        names: Sequence[str],
        fingerprint: str,
        make: Callable[[], Mapping[str, TransferMatrix]],
    ) -> dict[str, TransferMatrix]:
        """Return blank matrices in the shape of those asked for."""
        first = len(self.plan.planned)
        made = dict(make())
        files = tuple(self.path(name, fingerprint).name for name in names)
        kept = all(self.holds(name, fingerprint) for name in names)
        twice = any(files == entry.files for entry in self.entries)
        if kept or twice:
            del self.plan.planned[first:]
        if not twice:
            jobs = range(first, len(self.plan.planned))
            matrices = tuple(made[name] for name in names)
            self.entries.append(_Entry(files, float(kept), matrices, jobs))
        return made

    def blocks(
        self,
        name: str,
        fingerprint: str,
        rows: Sequence[slice],
        make: Callable[[slice], TransferMatrix],
    ) -> tuple[Path, ...]:
        """Take note of the whole matrix, and of how much of it is kept."""
        first, whole = len(self.plan.planned), rows[-1].stop
        matrix = make(slice(0, whole))
        parts = zip(block_names(name, len(rows)), rows, strict=True)
        kept = sum(r.stop - r.start for n, r in parts if self.holds(n, fingerprint))
        files = (self.path(name, fingerprint).name,)
        twice = any(files == entry.files for entry in self.entries)
        if kept == whole or twice:
            del self.plan.planned[first:]
        if not twice:
            jobs = range(first, len(self.plan.planned))
            entry = _Entry(files, kept / whole, (matrix,), jobs, stored=True)
            self.entries.append(entry)
        return ()


def plan_study(study: Study, *, out: str | Path) -> StudyPlan:
    """Return what a run of a study into a folder will take.

    Traces for about a second for each kind of matrix, to learn how fast it goes.

    Parameters
    ----------
    study : from `read_study`
    out : folder whose matrices will be found again

    Raises
    ------
    InputError : a file of the study is wrong
    DeviceError : no usable compute device
    """
    with executor_at(study.trace.cluster) as place:
        plan = Plan(place)
        store = PlannedStore(MatrixStore(Path(out) / MATRIX_FOLDER), plan)
        for method in study.methods:
            inputs = _walk_through(study.with_method(method), store, plan)
        return _planned(study, inputs, store, estimate_costs(plan))


def _walk_through(study: Study, store: PlannedStore, plan: Plan) -> Inputs:
    # Ask for everything that a run asks for
    inputs = read_inputs(study)
    job = Job(study, inputs, store, _silent, executor=plan)
    for view in trace_views(job, trace_study(job)):
        for number, group in enumerate(inputs.groups if view.matrices.suns else ()):
            for state in range(len(group.states)):
                view.sun(number, state)
    trace_lamps(job)
    return inputs


def _silent(_phase: str) -> Progress:
    return lambda _share, _note: None


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
    # Illuminance and its error; the terms of the direct correction, direct sun, lamps
    variables = 2 + bool(study.lighting)
    if needs_direct(study):
        variables += 1 + 3 * study.corrected
    return 4 * variables + _TEXT * (study.output.csv + study.output.ill)


def _leaving(entry: _Entry, steps: int) -> int:
    # Patches by steps with light, half of all, with each error component and without
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
    # As many as flat surfaces have, and a hundred for each round one
    count = 0
    for surface in scene.surfaces:
        if isinstance(surface, TriangleMesh):
            count += len(surface.faces)
        else:
            count += len(surface.vertices) - 2 if isinstance(surface, Polygon) else 100
    return count
