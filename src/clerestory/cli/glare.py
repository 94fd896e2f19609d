"""`clerestory glare`: glare indices of pictures, as evalglare computes them."""

import json
from collections.abc import Sequence
from dataclasses import asdict, replace
from pathlib import Path

import numpy as np
import typer

from clerestory.checks import one_of, require
from clerestory.cli import glare_text
from clerestory.cli.progress import progress_display, say
from clerestory.cli.requests.glare import GlareRequest
from clerestory.escaping import csv_line
from clerestory.files import replace_file, write_text
from clerestory.glare.evalglare_options import EvalglareOptions
from clerestory.glare.evaluate import Evaluation
from clerestory.glare.luminance_statistics import field_luminances
from clerestory.glare.picture_evaluation import annual_glare_of_files, evaluate_file
from clerestory.image.picture_files import write_picture


def glare(request: GlareRequest) -> None:
    """Compute the glare indices of pictures, and print or write them."""
    options = _options(request)
    indices, files = options.indices, request.files
    require(
        indices.fill is None or indices.illuminance is None,
        "both --illuminance and --fill are given; one of them expected",
    )
    require(
        request.check is None or len(files) == 1,
        f"--check is given with {len(files)} pictures; one picture expected",
    )
    require(
        len(request.error) in (0, len(files)),
        f"--error is given {len(request.error)} times for {len(files)} pictures; once"
        " for each picture expected",
    )
    if request.annual is not None:
        _write_annual(request, request.annual, options)
        return
    errors: Sequence[Path | None] = request.error or [None] * len(files)
    records: list[dict[str, object]] = []
    with progress_display(quiet=request.quiet) as display:
        progress = display("glare")
        for done, (file, error) in enumerate(zip(files, errors, strict=True)):
            found = evaluate_file(file, options, error=error)
            if request.check is not None:
                show_task = request.shown_task is not None
                shown = found.check_picture(colour=request.colour, show_task=show_task)
                write_picture(shown, request.check)
            if request.form == "text":
                say(*_text(found, request))
            records.append({"picture": str(file), **_record(found)})
            progress((done + 1) / len(files), str(file))
    if request.form == "json":
        say(json.dumps(records, indent=2))
    elif request.form == "csv":
        typer.echo(_csv(records), nl=False)


def _options(request: GlareRequest) -> EvalglareOptions:
    # Option -T, which colours the task zone, also defines it
    if request.shown_task is None:
        return request.options
    sources = replace(request.options.sources, task=request.shown_task)
    return replace(request.options, sources=sources)


def _text(found: Evaluation, request: GlareRequest) -> list[str]:
    if request.only_illuminance:
        return [f"{found.result.illuminance:.6f}"]
    lines = []
    for name, part in found.regions.items():
        lines.append(glare_text.region_line(name, part))
        if name == "mask":
            votes = found.window_votes()
            numbers = " ".join(f"{vote:.6f}" for vote in votes.values())
            lines.append(f"{','.join(votes)}: {numbers}")
    if not request.detail:
        return [*lines, *glare_text.short_lines(found.result)]
    field = field_luminances(found.luminance, found.eye)
    return [
        *lines,
        *glare_text.source_lines(found.result),
        *glare_text.long_lines(found.result, field),
    ]


def _record(found: Evaluation) -> dict[str, object]:
    field = field_luminances(found.luminance, found.eye)
    values = found.result.values()
    return {
        **{name: x if np.isfinite(x) else None for name, x in values.items()},
        **{
            f"{name}_error": x if np.isfinite(x) else None
            for name, x in found.result.errors.items()
        },
        **{f"{name}_luminance": value for name, value in field._asdict().items()},
        **{name: asdict(part) for name, part in found.regions.items()},
        **found.window_votes(),
        "sources": glare_text.source_rows(found.result.sources),
    }


def _csv(records: list[dict[str, object]]) -> str:
    # CSV text: one line per picture, without glare sources and zone statistics
    names = [name for name, x in records[0].items() if not isinstance(x, list | dict)]
    rows = ([_cell(record[name]) for name in names] for record in records)
    return "".join(f"{csv_line(row)}\n" for row in (names, *rows))


def _cell(value: object) -> str:
    return "" if value is None else str(value)


def _write_annual(request: GlareRequest, out: Path, options: EvalglareOptions) -> None:
    files, quiet = request.files, request.quiet
    one_of(out.suffix, "extension of --annual", choices=(".nc", ".csv"))
    with progress_display(quiet=quiet) as display:
        data = annual_glare_of_files(
            files, options, errors=request.error, progress=display("glare")
        )
    if out.suffix == ".csv":
        write_text(out, data.to_dataframe().to_csv())
    else:
        with replace_file(out) as stream:
            stream.write(bytes(data.to_netcdf(engine="h5netcdf")))
    say(f"{out}: glare of {len(files)} pictures", quiet=quiet)
