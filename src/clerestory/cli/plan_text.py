"""Table of the plan of a run."""

from rich.table import Table

from clerestory.study.run_plan import PlannedMatrix, StudyPlan


def plan_table(plan: StudyPlan) -> Table:
    """Return a table with one line per matrix, and the totals as caption."""
    where = (
        f"{plan.workers} workers, {plan.device}" if plan.workers > 1 else plan.device
    )
    table = Table(title=f"Matrices, traced on {where}", title_justify="left")
    table.add_column("matrix")
    for heading in ("rows", "columns", "paths", "time", "disk"):
        table.add_column(heading, justify="right")
    for matrix in plan.matrices:
        table.add_row(*_line(matrix))
    if plan.later.paths:
        paths, seconds = _count(plan.later.paths), duration(plan.later.seconds)
        table.add_row("direct sun in pictures", "", "", paths, seconds, "")
    table.caption = (
        f"tracing about {duration(plan.seconds)}, memory about {size(plan.memory)},"
        f" disk {size(plan.disk)}"
    )
    table.caption_justify = "left"
    return table


def _line(matrix: PlannedMatrix) -> list[str]:
    name, _, _ = matrix.file.rpartition("-")
    shape = [f"{matrix.rows:,}", f"{matrix.columns:,}"]
    if matrix.kept:
        return [name, *shape, "", "kept", ""]
    seconds = duration(matrix.seconds) if matrix.seconds else "with it"
    return [name, *shape, _count(matrix.paths), seconds, size(matrix.bytes)]


def _count(paths: int) -> str:
    if paths < 1e6:
        return f"{paths:,}"
    return f"{paths * 1e-6:,.0f} million"


def duration(seconds: float) -> str:
    """Return a duration in words.

    >>> duration(0.4), duration(75), duration(8000)
    ('1 s', '75 s', '2.2 h')
    """
    if seconds < 100:
        return f"{max(1, round(seconds))} s"
    if seconds < 6000:
        return f"{seconds / 60:.0f} min"
    return f"{seconds / 3600:.1f} h"


def size(count: float) -> str:
    """Return a number of bytes in words.

    >>> size(20_000), size(3.2e8), size(5e10)
    ('1 MB', '320 MB', '50.0 GB')
    """
    if count < 1e9:
        return f"{max(1, round(count / 1e6))} MB"
    return f"{count / 1e9:.1f} GB"
