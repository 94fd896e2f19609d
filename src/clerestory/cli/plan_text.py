"""Tables of the estimated cost of a run: its matrices and its stages."""

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rich.table import Table

from clerestory.study.run_plan import PlannedMatrix, StudyPlan


def plan_table(plan: StudyPlan) -> Table:
    """Return the table of the matrices of a run with their tracing costs."""
    where = (
        f"{plan.workers} workers, {plan.device}" if plan.workers > 1 else plan.device
    )
    table = Table(title=f"Matrices, traced on {where}", title_justify="left")
    table.add_column("matrix")
    for heading in ("rows", "columns", "paths", "time", "disk"):
        table.add_column(heading, justify="right")
    for matrix, count in _by_name(plan.matrices):
        name, *cells = _line(matrix)
        table.add_row(f"{count} × {name}" if count > 1 else name, *cells)
    if plan.later.paths:
        paths, seconds = _count(plan.later.paths), _duration(plan.later.seconds)
        table.add_row("direct sun in pictures", "", "", paths, seconds, "")
    return table


def stage_table(plan: StudyPlan) -> Table:
    """Return the table of the stages of a run; the caption gives total costs."""
    table = Table(title="Stages of the run", title_justify="left")
    for heading in ("stage", "work"):
        table.add_column(heading)
    for heading in ("time", "files", "disk"):
        table.add_column(heading, justify="right")
    for name, stage in plan.stages.items():
        files = [f"{stage.files:,}", _size(stage.bytes)] if stage.files else ["", ""]
        shown = "pictures, glare" if name == "pictures" else name
        table.add_row(shown, stage.work, _duration(stage.seconds), *files)
    table.caption = (
        f"about {_duration(plan.run_seconds)}, memory about {_size(plan.memory)},"
        f" disk {_size(plan.disk)}"
    )
    table.caption_justify = "left"
    return table


def _by_name(matrices: Sequence[PlannedMatrix]) -> Iterator[tuple[PlannedMatrix, int]]:
    # Matrices of one name and shape, those of several variants, as one with their sums
    groups: dict[tuple[object, ...], list[PlannedMatrix]] = {}
    for one in matrices:
        key = _name(one), one.kept, one.rows, one.columns
        groups.setdefault(key, []).append(one)
    for group in groups.values():
        together = replace(
            group[0],
            bytes=sum(one.bytes for one in group),
            paths=sum(one.paths for one in group),
            seconds=sum(one.seconds for one in group),
        )
        yield together, len(group)


def _name(matrix: PlannedMatrix) -> str:
    return matrix.file.rpartition("-")[0]


def _line(matrix: PlannedMatrix) -> list[str]:
    name = _name(matrix)
    shape = [f"{matrix.rows:,}", f"{matrix.columns:,}"]
    if matrix.kept:
        return [name, *shape, "", "kept", ""]
    seconds = _duration(matrix.seconds) if matrix.seconds else "with it"
    return [name, *shape, _count(matrix.paths), seconds, _size(matrix.bytes)]


def _count(paths: int) -> str:
    if paths < 1e6:
        return f"{paths:,}"
    return f"{paths * 1e-6:,.0f} million"


def _duration(seconds: float) -> str:
    if seconds < 0.5:
        return "< 1 s"
    if seconds < 100:
        return f"{round(seconds)} s"
    if seconds < 6000:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def _size(count: float) -> str:
    if count < 1e9:
        return f"{max(1, round(count / 1e6))} MB"
    return f"{count / 1e9:.1f} GB"
