"""`clerestory doctor`: checks of compute devices and libraries."""

import typer

from clerestory.cli.requests.study import Doctor
from clerestory.engine.device import describe


def doctor(_request: Doctor) -> None:
    """Print compute devices and libraries; exit with status 1 if one is broken."""
    findings = describe()
    width = max(len(finding.name) for finding in findings)
    for finding in findings:
        mark = "ok  " if finding.good else "FAIL"
        typer.echo(f"{mark}  {finding.name:{width}}  {finding.value}")
    if not all(finding.good for finding in findings):
        raise typer.Exit(1)
