"""`clerestory irradiance`: sensors under one sky, like rtrace -I."""

import sys
import time
from pathlib import Path

import numpy as np
import typer

from clerestory.cli.effort import tracing
from clerestory.cli.progress import say
from clerestory.cli.render import sky_of
from clerestory.cli.requests.render import Irradiance
from clerestory.escaping import csv_line
from clerestory.files import write_text
from clerestory.phases.rendering import Gathered
from clerestory.phases.rendering import irradiance as gather
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.scene_checks import warn_of_scene
from clerestory.scene.sensors import Sensors, parse_sensors, read_sensors


def irradiance(request: Irradiance) -> None:
    """Compute irradiance of sensors; print it or write it as a table."""
    begin = time.perf_counter()
    room = read_rad(*request.scene) + sky_of(request.sky)
    sensors = _sensors(request.sensors)
    warn_of_scene(room, (), sensors)
    with tracing(request.effort, quiet=request.quiet) as effort:
        found = gather(room, sensors, effort=effort("irradiance"))
    text = _csv(sensors, found) if request.form == "csv" else _lines(found)
    if request.output is None:
        typer.echo(text, nl=False)
        return
    write_text(request.output, text)
    seconds = time.perf_counter() - begin
    say(f"{request.output}: {_summary(found)}, {seconds:.1f} s", quiet=request.quiet)


def _sensors(path: Path) -> Sensors:
    if str(path) == "-":
        return parse_sensors(sys.stdin.read(), "standard input")
    return read_sensors(path)


def _csv(sensors: Sensors, found: Gathered) -> str:
    bands = found.bands.names
    names = ["x", "y", "z", "dx", "dy", "dz", "illuminance_lux", "error_lux"]
    names += [f"{band}_W_m2" for band in bands]
    names += [f"error_{band}_W_m2" for band in bands]
    place = np.hstack([sensors.position, sensors.direction])
    lux = np.column_stack([found.illuminance(), found.illuminance_error])
    values = np.hstack([lux, found.irradiance, found.error])
    rows = (
        csv_line([*(f"{x:.9g}" for x in where), *(f"{x:.6g}" for x in row)])
        for where, row in zip(place, values, strict=True)
    )
    return "\n".join([csv_line(names), *rows, ""])


def _lines(found: Gathered) -> str:
    return "".join(
        "\t".join(f"{x:.6e}" for x in row) + "\n" for row in found.irradiance
    )


def _summary(found: Gathered) -> str:
    lux, error = found.illuminance(), found.illuminance_error
    lit = lux > 0
    share = f"{np.median(error[lit] / lux[lit]):.2%}" if lit.any() else "0 %"
    return (
        f"{len(lux)} sensors, mean {lux.mean():.4g} lux, standard error of a sensor"
        f" {share} (median); {found.paths:,} paths"
    )
