"""`clerestory bsdf`: what a BSDF file holds."""

from pathlib import Path
from typing import Annotated

import numpy as np
import typer

from clerestory.bsdf.matrix import FUNCTIONS, Bsdf, Function
from clerestory.bsdf.xml import read_bsdf

app = typer.Typer(no_args_is_help=True, help="BSDF files of layers.")

BsdfFile = Annotated[
    Path, typer.Argument(metavar="FILE", help="BSDF file of LBNL's WINDOW or genBSDF.")
]


@app.command(epilog="Example: clerestory bsdf info blind.xml")
def info(file: BsdfFile) -> None:
    """Say what a BSDF file holds: product, bases, and how much light passes."""
    bsdf = read_bsdf(file)
    product = bsdf.product
    rows = {
        "name": product.name,
        "manufacturer": product.manufacturer,
        "device type": product.device_type,
        "channels": ", ".join(bsdf.channels),
    }
    for name, value in rows.items():
        typer.echo(f"{name:22}{value or '-'}")
    for channel in bsdf.channels:
        for function in FUNCTIONS:
            if (channel, function) in bsdf.functions:
                typer.echo(
                    f"{_title(channel, function):34}{_line(bsdf, channel, function)}"
                )
    for note in bsdf.notes:
        typer.echo(f"{'note':22}{note}")


def _title(channel: str, function: Function) -> str:
    return f"{channel} {function.replace('_', ' ')}"


def _line(bsdf: Bsdf, channel: str, function: Function) -> str:
    # Basis, and the share scattered from the normal and under a uniform sky
    part = bsdf.function(function, channel=channel)
    share = part.direct_hemispherical()
    weight = part.incidents.projected_solid_angles()
    normal = int(np.argmax(part.incidents.centres()[:, 2]))
    diffuse = float(share @ weight / weight.sum())
    return (
        f"{len(part.exits)} x {len(part.incidents)} ({part.exits.name}):"
        f" {share[normal]:.3f} from the normal, {diffuse:.3f} diffuse"
    )
