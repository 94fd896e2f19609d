"""`clerestory glare`: glare of pictures, as evalglare evaluates it."""

import csv
import io
import json
from collections.abc import Iterator
from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
import typer

from clerestory.cli import glare_options as options
from clerestory.cli.glare_job import Evaluation, Job, evaluate, window_votes
from clerestory.cli.glare_text import (
    long_line,
    region_line,
    short_line,
    source_lines,
    source_rows,
)
from clerestory.cli.options import Quiet
from clerestory.cli.progress import progress_display
from clerestory.errors import InputError
from clerestory.files import replace_file, write_text
from clerestory.glare.annual_glare import annual_glare
from clerestory.glare.evaluate import eye_of
from clerestory.glare.field_luminance import field_luminances
from clerestory.image.picture_files import read_picture


def glare(
    files: options.Pictures,
    form: options.Format = "text",
    detail: options.Detail = False,
    threshold: options.Threshold = None,
    task: options.Task = None,
    shown_task: options.ShownTask = None,
    merge_angle: options.MergeAngle = 0.2,
    smooth: options.Smooth = False,
    peak: options.Peak = 50_000.0,
    split_peaks: options.SplitPeaks = True,
    smallest: options.Smallest = 0.0,
    field: options.FieldCut = None,
    illuminance: options.Illuminance = None,
    fill: options.Filled = None,
    background: options.Background = "cie",
    correction: options.Correction = "0",
    age: options.Age = None,
    position: options.Position = "0",
    view: options.ViewText = None,
    mask: options.Mask = None,
    band: options.Band = None,
    zone: options.OneZone = None,
    zones: options.TwoZones = None,
    check: options.Check = None,
    colour: options.Colour = None,
    weights: options.Weights = None,
    only_illuminance: options.OnlyIlluminance = False,
    trust: options.Trust = False,
    annual: options.Annual = None,
    quiet: Quiet = False,
) -> None:
    """Find the glare sources of fisheye pictures and print DGP, DGI, UGR, VCP and CGI.

    Options have the letters of evalglare's and mean the same; only its -q is
    --background here.
    """
    job = Job(
        threshold=threshold,
        task=shown_task or task,
        merge_angle=merge_angle,
        smooth=smooth,
        peak=peak if split_peaks else None,
        smallest=smallest,
        field=field,
        illuminance=illuminance,
        fill=fill,
        background=background,
        low_light=correction == "l+",
        age=age,
        position=position,
        view=view,
        mask=mask,
        band=band,
        zone=zone,
        zones=zones,
        check=check,
        show_task=shown_task is not None,
        colour=colour,
        weights=weights,
        trust=trust,
    )
    if fill is not None and illuminance is not None:
        raise InputError("both --illuminance and --fill; one of them expected")
    if check is not None and len(files) > 1:
        raise InputError(f"one check picture for {len(files)} pictures; one expected")
    if annual is not None:
        _write_annual(files, annual, job, quiet=quiet)
        return
    with progress_display(quiet=quiet) as display:
        report = display("glare")
        records = []
        for done, file in enumerate(files):
            found = evaluate(file, job)
            if form == "text":
                _print_text(found, detail=detail, alone=only_illuminance)
            records.append({"picture": str(file), **_record(found)})
            report((done + 1) / len(files), str(file))
    if form == "json":
        typer.echo(json.dumps(records, indent=2))
    elif form == "csv":
        typer.echo(_csv(records), nl=False)


def _print_text(found: Evaluation, *, detail: bool, alone: bool) -> None:
    if alone:
        typer.echo(f"{found.result.illuminance:.6f}")
        return
    for name, part in found.regions.items():
        typer.echo(region_line(name, part))
        if name == "mask":
            votes = window_votes(found.result, part)
            numbers = " ".join(f"{vote:.6f}" for vote in votes.values())
            typer.echo(f"{','.join(votes)}: {numbers}")
    if not detail:
        typer.echo(short_line(found.result))
        return
    for line in source_lines(found.result):
        typer.echo(line)
    typer.echo(long_line(found.result, field_luminances(found.luminance, found.eye)))


def _record(found: Evaluation) -> dict[str, Any]:
    field = field_luminances(found.luminance, found.eye)
    return {
        **{name: _finite(value) for name, value in found.result.values().items()},
        **{f"{name}_luminance": value for name, value in field._asdict().items()},
        **{name: asdict(part) for name, part in found.regions.items()},
        **(
            window_votes(found.result, found.regions["mask"])
            if "mask" in found.regions
            else {}
        ),
        "sources": source_rows(found.result.sources),
    }


def _finite(value: float) -> float | None:
    return value if np.isfinite(value) else None


def _csv(records: list[dict[str, Any]]) -> str:
    # One line a picture; tables within a record have no place in it
    flat = [
        {
            name: value
            for name, value in record.items()
            if not isinstance(value, list | dict)
        }
        for record in records
    ]
    text = io.StringIO()
    writer = csv.DictWriter(text, fieldnames=list(flat[0]), lineterminator="\n")
    writer.writeheader()
    writer.writerows(flat)
    return text.getvalue()


def _write_annual(files: list[Path], out: Path, job: Job, *, quiet: bool) -> None:
    if out.suffix not in (".nc", ".csv"):
        raise InputError(f'annual file "{out}"; .nc or .csv expected')
    first = read_picture(files[0])
    seen = eye_of(first, view=job.other_view(), trust=job.trust).view
    with progress_display(quiet=quiet) as display:
        report = display("glare")

        def luminances() -> Iterator[np.ndarray]:
            for done, file in enumerate(files):
                yield read_picture(file).luminance()
                report((done + 1) / len(files), str(file))

        options_ = job.summary_options()
        given = options_.pop("given_illuminance")
        age = options_.pop("age")
        if age is not None or given is not None:
            raise InputError("--age and --illuminance are for single pictures")
        data = annual_glare(luminances(), seen, rules=job.rules(first.rows), **options_)
    if out.suffix == ".csv":
        write_text(out, data.to_dataframe().to_csv())
    else:
        with replace_file(out) as stream:
            stream.write(bytes(data.to_netcdf(engine="h5netcdf")))
    if not quiet:
        typer.echo(f"{out}: glare of {len(files)} pictures")
