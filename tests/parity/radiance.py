"""Radiance's programs, the reference of parity tests."""

import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

pyradiance = pytest.importorskip("pyradiance", reason="pyradiance is the reference")

_HOME = Path(pyradiance.__file__).parent
ENVIRONMENT = {
    **os.environ,
    "PATH": f"{_HOME / 'bin'}:{os.environ['PATH']}",
    "RAYPATH": f".:{_HOME / 'lib'}",
}


def run(command, *, folder, stdin=None):
    """Run a shell command of Radiance in a folder and return its output."""
    done = subprocess.run(
        command,
        shell=True,
        cwd=folder,
        env=ENVIRONMENT,
        input=stdin,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stderr}"
    return done.stdout


def matrix(text, channel=0):
    """Parse rfluxmtx's ASCII output without header: one channel (row, column)."""
    rows = [np.fromstring(line, sep=" ") for line in text.splitlines() if line.strip()]
    return np.array(rows).reshape(len(rows), -1, 3)[:, :, channel]
