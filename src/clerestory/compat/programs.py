"""Programs by name, and the folder of scripts that stand for them in PATH.

A program is imported when it is called, since filters in scripts must start fast.
"""

import importlib
import shlex
import stat
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from clerestory.checks import one_of
from clerestory.compat.streams import Streams
from clerestory.files import make_folder, write_text

# Module of each program
PROGRAMS = {
    "rfluxmtx": "rfluxmtx",
    "rcontrib": "rcontrib",
    "dctimestep": "matrix_programs",
    "rmtxop": "matrix_programs",
    "gendaymtx": "gendaymtx",
    "genskyvec": "genskyvec",
}


def run_program(name: str, words: Sequence[str], streams: Streams) -> None:
    r"""Run a program with the words of its command line.

    Raises
    ------
    InputError : the program or an option is unknown, or an input is invalid

    Examples
    --------
    >>> import io, tempfile
    >>> path, out = Path(tempfile.mkdtemp(), "a.mtx"), io.BytesIO()
    >>> _ = path.write_text("#?RADIANCE\nNCOLS=2\nNCOMP=1\nFORMAT=ascii\n\n1 2\n")
    >>> run_program("rmtxop", ["-t", "-s", "3", str(path)], Streams(sink=out))
    >>> out.getvalue().split()[-2:]
    [b'3', b'6']
    """
    one_of(name, "program", choices=tuple(PROGRAMS))
    module: Any = importlib.import_module(f"clerestory.compat.{PROGRAMS[name]}")
    getattr(module, name)(words, streams)


def install_programs(folder: str | Path, names: Sequence[str]) -> list[Path]:
    """Write a script for each program, to be put first in PATH; return the paths.

    The scripts call this Python and this package.
    """
    target, scripts = make_folder(folder), []
    entry = "import sys; from clerestory.cli.main import main; sys.exit(main())"
    start = f"exec {shlex.quote(sys.executable)} -c {shlex.quote(entry)} compat"
    for name in names:
        path = target / name
        write_text(path, f'#!/bin/sh\n{start} {name} "$@"\n')
        path.chmod(path.stat().st_mode | stat.S_IXUSR | stat.S_IXGRP | stat.S_IXOTH)
        scripts.append(path)
    return scripts
