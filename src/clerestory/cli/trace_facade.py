"""`clerestory trace facade`: façade matrices of shades that stand off a window."""

import time
from dataclasses import replace
from pathlib import Path
from typing import Annotated

import typer

from clerestory.cli.options import Output, SceneFiles, WindowFiles
from clerestory.cli.progress import progress_display
from clerestory.cli.trace_options import TraceOptions
from clerestory.cli.traced import warn_of_doubts, write_traced
from clerestory.cluster.cluster import executor_at
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.facade_matrices import facade_matrices
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.window_reader import read_windows

PortFiles = Annotated[
    list[Path],
    typer.Option(
        "--port",
        help="Radiance files of ports whose front faces the window.",
        metavar="F…",
    ),
]


def facade(
    scene: SceneFiles,
    window: WindowFiles,
    port: PortFiles,
    output: Output,
    *,
    options: TraceOptions,
) -> None:
    """Façade matrix: radiance of window patches per radiance of patches of ports.

    Ports close the space before the window that holds a shade. Several of them write
    one file each: F.nc becomes F-top.nc; with several windows, F-south-top.nc.
    """
    begin = time.perf_counter()
    room, windows, ports = read_rad(*scene), read_windows(*window), read_windows(*port)
    warn_of_doubts(room, windows)
    traced: dict[str, TransferMatrix] = {}
    with (
        executor_at(options.cluster) as executor,
        progress_display(quiet=options.quiet) as display,
    ):
        for number, each in enumerate(windows):
            progress = display(f"façade matrix of {each.name}")
            effort = options.effort(executor, progress)
            effort = replace(effort, seed=options.seed + number)
            found = facade_matrices(room, each, ports, effort=effort)
            prefix = f"{each.name}-" if len(windows) > 1 else ""
            traced |= {prefix + name: matrix for name, matrix in found.items()}
    write_traced(
        "facade",
        traced,
        output,
        encoding=options.encoding,
        quiet=options.quiet,
        begin=begin,
    )
