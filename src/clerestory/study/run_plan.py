"""Dry run: estimate of time, memory and disk space of a run.

A dry run has the same stages as a run, with an executor that records the tracing jobs
instead of executing them. Matrices in the cache have no cost. The cost of the stages
after tracing is estimated in `stage_costs`.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from clerestory.cluster.cluster import executor_at
from clerestory.engine.cost_estimate import JobCost, Plan, estimate_costs
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_equation import Skies
from clerestory.phases.matrix_store import MatrixStore
from clerestory.phases.picture_series import block_bytes
from clerestory.phases.stored_views import FEW
from clerestory.progress import silent
from clerestory.scene.model import Polygon, Scene, TriangleMesh
from clerestory.study.config import Study
from clerestory.study.glazed_grid_points import grid_points
from clerestory.study.input_checks import warn_of_inputs
from clerestory.study.inputs import read_inputs
from clerestory.study.job import Job
from clerestory.study.luminaire_matrices import trace_lamps
from clerestory.study.planned_store import PlannedEntry, PlannedStore
from clerestory.study.results import recorded_seconds
from clerestory.study.run_log import RunLog
from clerestory.study.stage_costs import STAGES, StageCost, StageWork, hour_bytes
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.study_run import MATRIX_FOLDER
from clerestory.study.study_skies import study_skies
from clerestory.study.study_tracing import trace_study
from clerestory.study.view_matrices import trace_views

# Memory besides that of matrices [bytes]: libraries and compiled kernels; largest
# memory of the accumulators for one block of matrix rows
_PROCESS, _SUMS = 450e6, 5 * 2**29

# Approximate memory per triangle [bytes], in main and GPU memory
_TRIANGLE = 400


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
    memory for the window radiance of all time steps if hourly results are in files,
    `pictures` the memory for the pictures of a view that are computed together. The
    `stages` are those of all methods, in order.
    """

    device: str
    workers: int
    matrices: tuple[PlannedMatrix, ...]
    later: JobCost
    results: int
    scene: int
    streamed: int = 0
    sky: int = 0
    pictures: int = 0
    stages: Mapping[str, StageCost] = field(default_factory=dict)

    @property
    def seconds(self) -> float:
        """Total tracing time of matrices that are not in the cache [s]."""
        return float(sum(m.seconds for m in self.matrices) + self.later.seconds)

    @property
    def memory(self) -> float:
        """Peak memory of the run [bytes]."""
        held = self.sky + sum(m.bytes for m in self.matrices if not m.stored)
        sums = max(
            (m.bytes * (32 if m.stored else 6) for m in self.matrices), default=0
        )
        sums = min(_SUMS, sums)
        # The accumulators are freed before window radiance is allocated; they exist at
        # the same time as hourly results in memory
        work = max(sums, self.streamed) if self.streamed else sums + self.results
        return _PROCESS + held + self.scene + max(work, self.results + self.pictures)

    @property
    def disk(self) -> int:
        """Disk space for new matrices, results and pictures [bytes]."""
        written = sum(stage.bytes for stage in self.stages.values())
        return written + sum(m.bytes for m in self.matrices if not m.kept)

    @property
    def run_seconds(self) -> float:
        """Total time of all stages of the run [s]."""
        return sum(stage.seconds for stage in self.stages.values())


def plan_study(*studies: Study, out: str | Path) -> StudyPlan:
    """Estimate the cost of a run of a study, or of its variants.

    Each kind of matrix is traced for about one second to measure the speed. Matrices
    in the folder `out` are reused. If the same study was run into this folder before,
    the time of stages other than tracing is that of the earlier run.
    """
    out, stages = Path(out), dict.fromkeys(STAGES, StageCost())
    with executor_at(studies[0].trace.cluster) as place:
        plan = Plan(place)
        store = PlannedStore(MatrixStore(out / MATRIX_FOLDER), plan)
        for study in studies:
            log = RunLog()
            for method in study.methods:
                one = study.with_method(method)
                work = _walk_through(one, store, plan, log)
                own = out / method if len(study.methods) > 1 else out
                costs = work.costs(log.seconds | recorded_seconds(own, one.facts()))
                stages = {name: stages[name] + cost for name, cost in costs.items()}
            if len(study.methods) > 1:
                # The results of the last method are written again, with a comparison
                again = replace(costs["write"], files=costs["write"].files + 1)
                stages["write"] += again
        planned = _planned(work, store, estimate_costs(plan))
    stages["trace"] = StageCost(seconds=planned.seconds)
    return replace(planned, stages=stages)


def _walk_through(
    study: Study, store: PlannedStore, plan: Plan, log: RunLog
) -> StageWork:
    # Request the matrices that a run would request; measure the stages before them
    with log.phase("read"):
        inputs = read_inputs(study)
    with log.phase("check"):
        warn_of_inputs(study, inputs)
    job = Job(study, inputs, store, silent, executor=plan)
    matrices = trace_study(job)
    views = trace_views(job, matrices)
    trace_lamps(job)
    with log.phase("sky"):
        skies = study_skies(study, inputs, matrices.suns)
    _plan_view_grids(job, matrices, skies, store)
    return StageWork(study, inputs, matrices, views, skies)


def _plan_view_grids(
    job: Job, matrices: StudyMatrices, skies: Skies, store: PlannedStore
) -> None:
    # The jobs of one position of each view grid, times the number of positions
    points, planned = grid_points(job, matrices, skies), store.plan.planned
    for grid in job.inputs.view_grids:
        first = len(planned)
        points.plan(grid)
        store.repeated[range(first, len(planned))] = len(grid)


def _planned(
    work: StageWork, store: PlannedStore, foreseen: Sequence[JobCost]
) -> StudyPlan:
    found, place, foreseen = [], store.plan.place, list(foreseen)
    for jobs, count in store.repeated.items():
        for number in jobs:
            cost = foreseen[number]
            foreseen[number] = JobCost(cost.paths * count, cost.seconds * count)
    for entry in store.entries:
        cost = _together([foreseen[number] for number in entry.jobs])
        left = 1 - entry.kept
        cost = JobCost(round(cost.paths * left), cost.seconds * left)
        for file, matrix in zip(entry.files, entry.matrices, strict=True):
            found.append(_matrix(file, matrix, cost, entry))
            cost = JobCost(cost.paths, 0.0)
    within = {number for entry in store.entries for number in entry.jobs}
    later = [each for n, each in enumerate(foreseen) if n not in within]
    study, inputs, steps = work.study, work.inputs, len(work.skies.times)
    pixels = max(map(len, inputs.cameras), default=0) if work.views else 0
    return StudyPlan(
        device=place.resolve(study.trace.device),
        workers=place.workers(),
        matrices=tuple(found),
        later=_together(later),
        results=hour_bytes(study) * len(inputs.sensors()) * steps,
        scene=_TRIANGLE * _triangles(inputs.scene),
        streamed=max((_leaving(e, steps) for e in store.entries), default=0),
        sky=work.skies.whole.diffuse.nbytes,
        pictures=block_bytes(pixels),
    )


def _leaving(entry: PlannedEntry, steps: int) -> int:
    # Bytes of window radiance and its error components in the daylit half of the time
    if not entry.stored:
        return 0
    channels, _, patches = entry.matrices[0].values.shape
    return int(4 * channels * patches * (2 * FEW + 1) * steps // 2)


def _together(parts: Sequence[JobCost]) -> JobCost:
    return JobCost(sum(p.paths for p in parts), sum(p.seconds for p in parts))


def _matrix(
    file: str, matrix: TransferMatrix, cost: JobCost, entry: PlannedEntry
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
