"""Findings of the quality checks of BSDFs."""

import re
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from clerestory.hemisphere.partition import RingPartition

Severity = Literal["info", "warning", "error"]

# Numbers in the effect of a finding
_NUMBER = re.compile(r"[0-9.]+")


@dataclass(frozen=True)
class Finding:
    """One irregularity of a BSDF."""

    name: str  # kind of irregularity: "energy", "reciprocity", "order", …
    # "error" if results are invalid, "warning" if they are doubtful, else "info"
    severity: Severity
    size: float  # deviation from the expected value, as stated in `what`
    what: str  # description, including the deviation
    where: str  # place: channel, scattering function, patch and direction
    effect: str  # consequence for a simulation

    @property
    def matters(self) -> bool:
        """Whether the irregularity can change simulation results."""
        return self.severity != "info"

    def __str__(self) -> str:
        return (
            f"{self.severity}: {self.name}: {self.what} ({self.where}); {self.effect}"
        )


def explained_once(findings: Iterable[Finding]) -> Iterator[str]:
    """Yield a line per finding; explanation and effect once for those of one kind.

    The visible and the solar channel often have findings that differ in numbers only.
    """
    explained = set()
    for finding in findings:
        kind = finding.name, finding.severity, _NUMBER.sub("", finding.effect)
        what = f"{finding.severity}: {finding.name}: {finding.what.split(': ')[0]}"
        short, line = f"{what} ({finding.where}); as above", str(finding)
        yield short if kind in explained and len(short) < len(line) else line
        explained.add(kind)


def severity_of(size: float, limits: tuple[float, float, float]) -> Severity | None:
    """Severity of a deviation; None if the deviation is at most the first limit.

    >>> severity_of(0.02, (0.001, 0.01, 0.05))
    'warning'
    """
    if not size > limits[0]:
        return None
    if size <= limits[1]:
        return "info"
    return "warning" if size <= limits[2] else "error"


def patch_label(partition: RingPartition, patch: int) -> str:
    """Index of a patch and direction of the patch centre, as text.

    >>> from clerestory.hemisphere.klems import klems
    >>> patch_label(klems("full"), 3)
    'patch 3 (10° off the normal, azimuth 90°)'
    """
    x, y, z = partition.centres()[patch]
    polar = np.degrees(np.arctan2(np.hypot(x, y), z))
    azimuth = np.degrees(np.arctan2(y, x)) % 360
    return f"patch {patch} ({polar:.0f}° off the normal, azimuth {azimuth:.0f}°)"
