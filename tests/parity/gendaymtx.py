"""Run gendaymtx, and measure how far a sky is from its matrix."""

import os
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pyradiance

BIN = Path(pyradiance.__file__).parent / "bin"


def gendaymtx(wea: Path, *options: str) -> np.ndarray:
    """Return the matrix (channel, patch, time) that gendaymtx makes of a WEA file."""
    command = [BIN / "gendaymtx", "-of", *options, wea]
    environment = {**os.environ, "RAYPATH": str(BIN.parent / "lib")}
    output = subprocess.run(
        command, capture_output=True, check=True, env=environment
    ).stdout
    head, _, body = output.partition(b"\n\n")
    if not body:
        return np.empty((3, 0, 0))
    fields = dict(line.split(b"=", 1) for line in head.splitlines() if b"=" in line)
    shape = int(fields[b"NROWS"]), int(fields[b"NCOLS"]), 3
    return np.frombuffer(body, "<f4").reshape(shape).transpose(2, 0, 1)


def epw_to_wea(epw: Path, wea: Path) -> None:
    """Write the WEA file of an EPW file, as Radiance does."""
    subprocess.run([BIN / "epw2wea", epw, wea], check=True, capture_output=True)


@dataclass(frozen=True)
class Distance:
    """The largest differences between two skies.

    Attributes
    ----------
    patch : in a patch, over the difference allowed, 0.5 % or 10⁻³ of the dome's mean
    plane : relative, of irradiance on the horizontal and four vertical planes
    direct : relative, of the sum over the dome, in which the sun weighs most
    """

    patch: float
    plane: float
    direct: float

    def worse(self, other: "Distance") -> "Distance":
        """Return the larger of each."""
        return Distance(
            max(self.patch, other.patch),
            max(self.plane, other.plane),
            max(self.direct, other.direct),
        )


def distance(ours: np.ndarray, theirs: np.ndarray, partition) -> Distance:
    """Return how far two matrices (channel, patch, time) are from each other."""
    mean = theirs[:, 1:].mean(axis=1, keepdims=True)
    allowed = np.maximum(0.005 * theirs, 1e-3 * mean) + 1e-7
    patch = float(np.max(np.abs(ours - theirs) / allowed, initial=0))

    # Integrals over the dome of one channel, in steps with light worth measuring
    x, y, z = partition.dome.centres().T
    solid_angle = partition.dome.solid_angles()
    planes = np.stack([z, *(np.maximum(c, 0) for c in (x, -x, y, -y))]) * solid_angle

    def largest(receivers: np.ndarray) -> float:
        mine, peer = (receivers @ sky[1, 1:].astype(float) for sky in (ours, theirs))
        lit = peer > 1e-2
        return float(np.max(np.abs(mine[lit] / peer[lit] - 1), initial=0))

    return Distance(patch, largest(planes), largest(solid_angle[None]))
