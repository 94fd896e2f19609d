"""`clerestory illum`: windows as lamps, computed once for one sky."""

import time
from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.options import (
    Bounces,
    ClusterAddress,
    DeviceOption,
    Quiet,
    RelativeError,
    Samples,
    SceneFiles,
    Seed,
)
from clerestory.cli.progress import progress_display
from clerestory.cli.render import Sky, Time, WeatherFile, sky_of
from clerestory.cluster.cluster import executor_at
from clerestory.errors import InputError
from clerestory.phases.window_emitters import precompute_illums
from clerestory.radiance.illum_table import write_illums
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Scene

Panes = Annotated[
    Path,
    typer.Option(
        "--panes",
        help="Scene file of the windows, in materials of the scene; fronts face in.",
        metavar="F",
    ),
]
Zone = Annotated[
    float,
    typer.Option(help="Longest edge of a piece with a table of its own [m]."),
]
Rings = Annotated[int, typer.Option(help="Rings of directions; twice as many around.")]
Lamps = Annotated[
    Path,
    typer.Option("--output", "-o", help="Scene file to write; tables go beside it."),
]


def illum(
    scene: SceneFiles,
    panes: Panes,
    output: Lamps,
    sky: Sky = None,
    moment: Time = None,
    weather: WeatherFile = None,
    zone: Zone = float("inf"),
    rings: Rings = 18,
    samples: Samples = None,
    relative_error: RelativeError = None,
    bounces: Bounces = None,
    seed: Seed = 1,
    device: DeviceOption = "auto",
    cluster: ClusterAddress = None,
    quiet: Quiet = False,
) -> None:
    """Make lamps of windows: trace once what they send under a sky, as mkillum does.

    Render with the file written in place of the file of the panes. Without --samples or
    --relative-error, paths are traced until the standard error of the mean direction is
    3 %.
    """
    begin = time.perf_counter()
    room = read_rad(*scene)
    windows = _windows(room, read_rad(*scene, panes), panes)
    with executor_at(cluster) as executor, progress_display(quiet=quiet) as display:
        made = precompute_illums(
            room + sky_of(sky, moment, weather),
            windows,
            zone=zone,
            rings=rings,
            samples=samples,
            relative_error=relative_error,
            bounces=bounces,
            seed=seed,
            device=device,
            executor=executor,
            progress=display("illum"),
        )
    files = write_illums(made, output)
    if not quiet:
        seconds = time.perf_counter() - begin
        typer.echo(
            f"{output}: {len(made.surfaces)} pieces of windows as lamps,"
            f" {len(files) - 1} tables, {seconds:.1f} s"
        )


def _windows(room: Scene, both: Scene, file: Path) -> Scene:
    # The surfaces of the last file, of materials that stay where they are
    found = both.surfaces[len(room.surfaces) :]
    for surface in found:
        if surface.material not in room.materials:
            raise InputError(
                f'pane "{surface.name}" is made of "{surface.material}", which is not'
                " defined in the scene; a material of a --scene file expected",
                file=file,
                line=surface.source.line if surface.source else None,
            )
    return Scene(both.materials, found)
