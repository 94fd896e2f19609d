"""Damaged pictures by the thousand: none may crash, hang, eat memory or slip NaN in.

Small pictures (run-length coded new and old, flat, XYZE; with and without a view) are
damaged in their headers and pixels, read, and evaluated for glare. Each is either
refused with an `InputError`, or its pixels and the indices are sound.

    python benchmarks/fuzz_pictures.py --count 20000 -o docs/benchmarks/picture-fuzz.md
"""

import argparse
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import dataclass, field
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from clerestory.errors import InputError
from clerestory.glare.evaluate import evaluate_glare
from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.image.radiance_hdr import read_radiance
from clerestory.scene.view import View

LONGEST = 10  # seconds a picture may take before it counts as hanging
MEMORY = 2 << 30  # bytes of address space
SIZE = 40  # pixels a side
LARGEST = 100_000  # pixels of pictures that are evaluated for glare

# What headers and resolution lines are damaged with
LINES = [
    *(b"-Y 40 +X 40", b"+Y 40 -X 40", b"-X 40 +Y 40", b"-Y 40", b"-Y -40 +X 40"),
    *(
        b"-Y 999999999 +X 999999999",
        b"-Y 4294967297 +X 1",
        b"-Y 0 +X 0",
        b"-Y 1e3 +X 9",
    ),
    *(
        b"FORMAT=32-bit_rle_rgbe",
        b"FORMAT=32-bit_rle_xyze",
        b"FORMAT=ascii",
        b"FORMAT=",
    ),
    *(
        b"EXPOSURE=0",
        b"EXPOSURE=nan",
        b"EXPOSURE=-1",
        b"EXPOSURE=1e-300",
        b"EXPOSURE=x",
    ),
    *(b"COLORCORR=0 1 1", b"COLORCORR=1 1", b"PIXASPECT=0", b"PIXASPECT=1e9"),
    *(b"PRIMARIES=0 0 0 0 0 0 0 0", b"VIEW= -vtq", b"VIEW= -vta -vh 0 -vv 0"),
    *(b"VIEW= -vta -vh nan -vv 180", b"VIEW= -vth -vh 999 -vv 999", b"VIEW= -vd 0 0 0"),
    *(b"VIEW= -vtl -vh 1 -vv 1", b"VIEW= -vta -vd 0 0 1 -vu 0 0 1 -vh 180 -vv 180"),
    *(b"\x00" * 20, b"\xff" * 40, b"=" * 3000, b"#?RADIANCE", b"NCOMP=3", b""),
]


@dataclass
class Outcome:
    """What became of a number of pictures."""

    loaded: int = 0
    evaluated: int = 0
    hangs: int = 0
    slowest_s: float = 0.0
    crashes: list[str] = field(default_factory=list)


class _TooLong(Exception):
    pass


def seeds(place: Path) -> list[bytes]:
    """Sound pictures, as files."""
    rng = np.random.default_rng(0)
    values = rng.uniform(0, 20, (SIZE, SIZE, 3)).astype(np.float32)
    values[5:12, 8:20] = 100
    path, files = place / "seed.hdr", []
    for view in (View(kind="angular", horizontal=180, vertical=180), None):
        write_picture(Picture(values, view=view), path)
        files.append(path.read_bytes())
    head, _, _ = files[0].partition(f"-Y {SIZE}".encode())
    head += f"-Y {SIZE} +X {SIZE}\n".encode()
    flat = rng.integers(1, 255, (SIZE * SIZE, 4), dtype=np.uint8)
    flat[:, 3] = rng.integers(120, 140, SIZE * SIZE)
    runs = np.tile(np.array([[90, 80, 70, 130], [1, 1, 1, 39]], np.uint8), (SIZE, 1))
    return [
        *files,
        head + flat.tobytes(),
        head + runs.tobytes(),
        files[0].replace(b"rle_rgbe", b"rle_xyze"),
    ]


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Return a picture with one to four faults, half of them in its header."""
    for _ in range(rng.integers(1, 5)):
        head = data.find(b"+X") + 8
        end = head if rng.random() < 0.5 else len(data) + 1
        at, size = int(rng.integers(max(end, 1))), int(rng.exponential(12)) + 1
        match rng.integers(6):
            case 0:
                data = data[:at] + rng.bytes(1) + data[at + 1 :]
            case 1:
                data = data[:at] + data[at + size :]
            case 2:
                data = data[:at] + rng.bytes(size) + data[at:]
            case 3:
                data = data[: at + size] + data[at:]
            case 4:
                data = data[:at] if rng.random() < 0.2 else data
            case _:
                data = _line_changed(data, rng)
    return data


def _line_changed(data: bytes, rng: np.random.Generator) -> bytes:
    # Put a line of the list in the place of one of the header, or before it
    lines = data.split(b"\n", 12)
    at = int(rng.integers(len(lines)))
    line = LINES[rng.integers(len(LINES))]
    lines[at : at + int(rng.integers(2))] = [line]
    return b"\n".join(lines)


def judge(path: Path, outcome: Outcome) -> None:
    """Read a picture and evaluate it; assert that what comes of it is sound."""
    try:
        picture = read_radiance(path)
    except InputError:
        return
    assert np.all(np.isfinite(picture.radiance)), "a pixel that is not finite"
    outcome.loaded += 1
    if picture.rows * picture.columns > LARGEST:
        return
    try:
        result = evaluate_glare(picture, trust=True)
    except InputError:
        return
    assert 0 <= result.dgp <= 1, f"a DGP of {result.dgp}"
    assert np.isfinite(result.illuminance), "an illuminance that is not finite"
    outcome.evaluated += 1


def run(count: int) -> Outcome:
    """Damage and judge pictures; number k depends on k alone."""

    def too_long(*_: object) -> None:
        raise _TooLong

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    signal.signal(signal.SIGALRM, too_long)
    warnings.simplefilter("ignore")
    outcome = Outcome()
    with tempfile.TemporaryDirectory() as place:
        originals = seeds(Path(place))
        path = Path(place, "damaged.hdr")
        for number in range(count):
            rng = np.random.default_rng(number)
            path.write_bytes(damaged(originals[number % len(originals)], rng))
            started = time.perf_counter()
            signal.alarm(LONGEST)
            try:
                judge(path, outcome)
            except _TooLong:
                outcome.hangs += 1
            except Exception:
                last = traceback.format_exc().strip().splitlines()
                outcome.crashes.append(f"{number}: {last[-1]} ({last[-3].strip()})")
            signal.alarm(0)
            took = time.perf_counter() - started
            outcome.slowest_s = max(outcome.slowest_s, took)
    return outcome


def page(outcome: Outcome, count: int) -> str:
    """Return the result as a page of the documentation."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    rows = {
        "damaged pictures": count,
        "refused with a message": count
        - outcome.loaded
        - outcome.hangs
        - len(outcome.crashes),
        "loaded, every pixel finite": outcome.loaded,
        "and evaluated for glare, DGP from 0 to 1": outcome.evaluated,
        "crashes": len(outcome.crashes),
        f"hangs (over {LONGEST} s)": outcome.hangs,
        "slowest picture": f"{outcome.slowest_s:.2f} s",
        "largest memory": f"{peak:.0f} MB",
    }
    table = "\n".join(f"| {name} | {value} |" for name, value in rows.items())
    return (
        "# Damaged pictures\n\n"
        f"Made by `benchmarks/fuzz_pictures.py` on {datetime.now(UTC):%d %B %Y}; NumPy"
        f" {np.__version__}.\n\n| | |\n| --- | --- |\n{table}\n"
    )


def main() -> None:
    """Run, print and write."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=20_000)
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    outcome = run(options.count)
    text = page(outcome, options.count)
    if options.output:
        options.output.write_text(text, encoding="utf-8")
    print(text, *outcome.crashes[:40], sep="\n")
    sys.exit(bool(outcome.crashes or outcome.hangs))


if __name__ == "__main__":
    main()
