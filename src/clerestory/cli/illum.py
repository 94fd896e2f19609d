"""`clerestory illum`: precomputed window emitters for one sky, like mkillum."""

import time
from pathlib import Path

from clerestory.checks import require
from clerestory.cli.effort import tracing
from clerestory.cli.progress import say
from clerestory.cli.render import sky_of
from clerestory.cli.requests.render import Illum
from clerestory.phases.window_emitters import precompute_illums
from clerestory.radiance.illum_table import write_illums
from clerestory.radiance.rad_reader import read_rad
from clerestory.scene.model import Scene


def illum(request: Illum) -> None:
    """Compute window emitters; write them as a scene file with data files."""
    begin = time.perf_counter()
    room = read_rad(*request.scene)
    panes = _panes(room, read_rad(*request.scene, request.panes), request.panes)
    with tracing(request.effort, quiet=request.quiet) as effort:
        made = precompute_illums(
            room + sky_of(request.sky),
            panes,
            zone=request.zone,
            rings=request.rings,
            effort=effort("illum"),
        )
    files = write_illums(made, request.output)
    say(
        f"{request.output}: {len(made.surfaces)} window emitters,"
        f" {len(files) - 1} data files, {time.perf_counter() - begin:.1f} s",
        quiet=request.quiet,
    )


def _panes(room: Scene, both: Scene, file: Path) -> Scene:
    # Surfaces of the pane file, whose materials must be defined in the scene files
    found = both.surfaces[len(room.surfaces) :]
    for surface in found:
        require(
            surface.material in room.materials,
            f'pane "{surface.name}" has the material "{surface.material}", which is not'
            " defined in the scene; a material of a --scene file expected",
            file=file,
            line=surface.source.line if surface.source else None,
        )
    return Scene(both.materials, found)
