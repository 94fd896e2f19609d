"""Check of angle basis names against the rings of the data."""

from collections.abc import Iterator

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.quality_finding import Finding
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition

_NAMES = ("full", "half", "quarter")


def check_labels(bsdf: Bsdf) -> Iterator[Finding]:
    """Yield bases defined otherwise than in WINDOW, and notes of the file reader."""
    seen: set[str] = set()
    for part in bsdf.functions.values():
        if not isinstance(part, ScatteringMatrix):
            continue
        for partition in (part.exits, part.incidents):
            finding = None if partition.name in seen else _label(partition)
            seen.add(partition.name)
            if finding is not None:
                yield finding
    for note in bsdf.notes:
        yield Finding(
            "reading", "info", 0.0, note, "file", "other programs may read it otherwise"
        )


def _label(partition: RingPartition) -> Finding | None:
    words = partition.name.lower()
    basis = next((name for name in _NAMES if f"klems {name}" in words), None)
    if basis is None:
        return None
    usual = klems(basis)
    if usual.matches(partition):
        return None
    same_count = len(usual) == len(partition)
    what = (
        f"{partition.name!r} with other ring limits than WINDOW's"
        if same_count
        else f"{partition.name!r} with {len(partition)} patches; WINDOW has"
        f" {len(usual)} under that name"
    )
    return Finding(
        "label",
        "warning",
        float(len(partition) - len(usual)),
        what,
        "angle basis",
        "programs that go by the name refuse the file or read light at wrong angles",
    )
