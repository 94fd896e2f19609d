"""`clerestory new`: a study file for a room, a window, a BSDF and a weather file."""

from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.options import Quiet, SceneFiles, WindowFiles
from clerestory.study.new_study import begin_study


def new(
    folder: Annotated[
        Path,
        typer.Argument(metavar="DIR", help="Folder for the study; made if need be."),
    ],
    scene: SceneFiles,
    window: WindowFiles,
    bsdf: Annotated[Path, typer.Option("--bsdf", help="BSDF file (.xml).")],
    weather: Annotated[
        Path, typer.Option("--weather", help="Weather file (.epw, .wea, .csv).")
    ],
    sensors: Annotated[
        Path | None,
        typer.Option("--sensors", help="Sensors, if not a grid over the floor."),
    ] = None,
    spacing: Annotated[
        float, typer.Option("--spacing", help="Of the grid [m].", min=0.05)
    ] = 0.5,
    height: Annotated[
        float, typer.Option("--height", help="Of the grid above the floor [m].", min=0)
    ] = 0.76,
    quiet: Quiet = False,
) -> None:
    """Write a study file: the room, its window, a grid over the floor, the weather.

    The scene is the room without the glazing of the window, which the BSDF replaces.
    A window that turns its back to the room is turned round in a copy.
    """
    begun = begin_study(
        folder,
        scene=scene,
        windows=window,
        bsdf=bsdf,
        weather=weather,
        sensors=sensors,
        spacing=spacing,
        height=height,
    )
    if not quiet:
        for name in begun.turned:
            typer.echo(f'window "{name}" turned round: its front must face the room')
        typer.echo(f"{begun.study}: {begun.sensors} sensors")
        typer.echo(f"next: clerestory run {begun.study}")
