"""Damaged files by the thousand: no reader may crash, hang or take much memory.

    python tests/fuzz/harness.py READER --count 10000 [--first N] [--keep FOLDER]

reads mutants of a reader's seed files, in one process with limited memory, and prints
what happened as JSON. A mutant is refused by one line of a `ClerestoryError`, or read.
"""

import argparse
import json
import resource
import signal
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import asdict, dataclass, field
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parent))

from mutation import mutant
from seeds import READERS, Reader

from clerestory.errors import ClerestoryError

LONGEST_S = 5  # a mutant that takes longer counts as a hang
MEMORY = 1 << 30  # bytes that reading may add to the process
MESSAGE = 500  # characters of the longest message


@dataclass
class Outcome:
    """What became of the mutants of one reader."""

    count: int = 0
    loaded: int = 0
    defects: list[str] = field(default_factory=list)
    slowest_s: float = 0.0
    peak_mb: float = 0.0


class TooLong(BaseException):
    """The time of a mutant is over; no `except Exception` may catch it."""


def _too_long(*_: object) -> None:
    raise TooLong


def run(name: str, count: int, *, first: int = 0, keep: Path | None = None) -> Outcome:
    """Read mutants `first` to `first + count` of a reader."""
    reader, outcome = READERS[name], Outcome(count)
    signal.signal(signal.SIGALRM, _too_long)
    warnings.simplefilter("ignore")
    with tempfile.TemporaryDirectory() as place:
        folder = Path(place)
        seeds = reader.seeds(folder)
        path = folder / reader.file
        for number, seed in enumerate(seeds):
            path.write_bytes(seed)
            try:
                reader.read(path)
            except ClerestoryError as error:
                outcome.defects.append(f"seed {number} is not read: {error}")
        _limit_memory()
        for number in range(first, first + count):
            data = mutant(seeds, number)
            path.write_bytes(data)
            fault = _judged(reader, path, outcome)
            if fault:
                outcome.defects.append(f"{number}: {fault}")
                if keep:
                    keep.mkdir(parents=True, exist_ok=True)
                    (keep / f"{name}-{number}{path.suffix}").write_bytes(data)
    outcome.peak_mb = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    return outcome


def _limit_memory() -> None:
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))


def _judged(reader: Reader, path: Path, outcome: Outcome) -> str:
    # Read a file; return its defect, or an empty text
    started = time.perf_counter()
    signal.alarm(LONGEST_S)
    try:
        reader.read(path)
        outcome.loaded += 1
    except ClerestoryError as error:
        return _faulty_message(str(error).replace(str(path.parent), ""))
    except TooLong:
        return f"hangs for more than {LONGEST_S} s"
    except Exception:
        last = traceback.format_exc().strip().splitlines()
        frames = [line.strip() for line in last if line.startswith("  File")]
        return f"{last[-1][:200]} ({frames[-1][-120:]})"
    finally:
        signal.alarm(0)
        took = time.perf_counter() - started
        outcome.slowest_s = max(outcome.slowest_s, took)
    return ""


def _faulty_message(text: str) -> str:
    if "unexpected error" in text or "Traceback" in text:
        return f"message: {text[:200]}"
    if "\n" in text:
        return f"message of several lines: {text[:200]!r}"
    if len(text) > MESSAGE:
        return f"message of {len(text)} characters: {text[:200]}"
    return ""


def main() -> None:
    """Run the mutants of one reader and print the outcome."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("reader", choices=READERS)
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--keep", type=Path, help="folder for the mutants with defects")
    given = parser.parse_args()
    outcome = run(given.reader, given.count, first=given.first, keep=given.keep)
    sys.stdout.write(json.dumps(asdict(outcome)) + "\n")


if __name__ == "__main__":
    main()
