"""Damaged files by the thousand: no reader may crash, hang or take much memory.

    python tests/fuzz/harness.py [READER …] --count 10000 [--first N] [--keep FOLDER]

reads mutants of the seed files of each reader and prints what happened, a line of JSON
for each reader. A mutant is refused by one line of an `InputError`, or read. Every
reader has a process of its own, forked from one that has imported the package.
"""

import argparse
import json
import mmap
import os
import resource
import signal
import struct
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import asdict, dataclass, field
from pathlib import Path
from types import FrameType

sys.path[:0] = [str(folder) for folder in Path(__file__).parents[:2]]

from mutation import mutant
from readers import READERS

from clerestory.errors import InputError

LONGEST_S = 5  # a mutant that takes longer, in processor time, counts as a hang
STUCK_S = 120  # the same in which Python does not run at all
MEMORY = 1 << 30  # bytes that reading may add to the process
MESSAGE = 500  # characters of the longest message


@dataclass
class Outcome:
    """What became of the mutants of one reader."""

    reader: str
    count: int = 0
    loaded: int = 0
    defects: list[str] = field(default_factory=list)
    slowest_s: float = 0.0
    memory_mb: float = 0.0
    cpu_s: float = 0.0


class TooLong(BaseException):
    """The time of a mutant is over; no `except Exception` may catch it."""


def run(name: str, count: int, *, first: int = 0, keep: Path | None = None) -> Outcome:
    """Read mutants `first` to `first + count` of a reader, in processes forked here."""
    whole, end = Outcome(name), first + max(1, count // READERS[name].cost)
    while first < end:
        part, first = _forked(name, first, end, keep)
        whole.count += part.count
        whole.loaded += part.loaded
        whole.defects += part.defects
        whole.cpu_s += part.cpu_s
        whole.slowest_s = max(whole.slowest_s, part.slowest_s)
        whole.memory_mb = max(whole.memory_mb, part.memory_mb)
    return whole


def _forked(name: str, first: int, end: int, keep: Path | None) -> tuple[Outcome, int]:
    # Outcome of a process, and the mutant that comes after those it has read
    at = mmap.mmap(-1, 8)
    at[:] = struct.pack("q", first - 1)
    with tempfile.TemporaryDirectory() as place:
        report, folder = Path(place, "outcome.json"), Path(place, "files")
        folder.mkdir()
        child = os.fork()
        if not child:
            _child(name, range(first, end), at, folder, report, keep)
        ended = _wait(child, at)
        if report.exists():
            return Outcome(**json.loads(report.read_text())), end
    (reached,) = struct.unpack("q", at)
    fault = f"{reached}: the process ended ({os.waitstatus_to_exitcode(ended)})"
    after = reached + 1 if reached >= first else end
    return Outcome(name, after - first, 0, [fault]), after


def _wait(child: int, at: mmap.mmap) -> int:
    # Status of a child process, which is killed if it is stuck in a library
    seen, since = bytes(at), time.monotonic()
    while True:
        found, status = os.waitpid(child, os.WNOHANG)
        if found:
            return status
        if bytes(at) != seen:
            seen, since = bytes(at), time.monotonic()
        elif time.monotonic() - since > STUCK_S:
            os.kill(child, signal.SIGKILL)
        time.sleep(0.01)


def _child(
    name: str,
    numbers: range,
    at: mmap.mmap,
    folder: Path,
    report: Path,
    keep: Path | None,
) -> None:
    # Read mutants and write the outcome; never return
    status = 1
    try:
        outcome = _outcome(name, numbers, at, folder, keep)
        report.write_text(json.dumps(asdict(outcome)))
        status = 0
    except BaseException:
        traceback.print_exc()
    finally:
        sys.stdout.flush()
        os._exit(status)


def _outcome(
    name: str, numbers: range, at: mmap.mmap, folder: Path, keep: Path | None
) -> Outcome:
    reader, outcome = READERS[name], Outcome(name, len(numbers))
    warnings.simplefilter("ignore")
    signal.signal(signal.SIGPROF, _too_long)
    seeds, read = reader.seeds(folder), reader.called()
    path = folder / reader.file
    for number, seed in enumerate(seeds):
        path.write_bytes(seed)
        try:
            read(path)
        except InputError as error:
            outcome.defects.append(f"seed {number} is not read: {error}")
    before = _limit_memory()
    began = time.process_time()
    for number in numbers:
        at[:] = struct.pack("q", number)
        data = mutant(seeds, number)
        if reader.sealed and number % 4:
            data = reader.sealed(data)
        path.write_bytes(data)
        fault = _judged(read, path, outcome)
        if fault:
            outcome.defects.append(f"{number}: {fault}")
            if keep:
                keep.mkdir(parents=True, exist_ok=True)
                kept = f"{name}-{number}{path.suffix}".replace(" ", "_")
                (keep / kept).write_bytes(data)
    outcome.cpu_s = time.process_time() - began
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    outcome.memory_mb = max(peak - before, 0) / 1024
    return outcome


def _too_long(*_: object) -> None:
    raise TooLong


def _limit_memory() -> int:
    # Limit what the process may add; return the largest memory so far [kB]
    used = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    resource.setrlimit(resource.RLIMIT_AS, (used + MEMORY, used + MEMORY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss


def _judged(read, path: Path, outcome: Outcome) -> str:
    # Read a file; return its defect, or an empty text
    started = time.process_time()
    signal.setitimer(signal.ITIMER_PROF, LONGEST_S)
    try:
        read(path)
        outcome.loaded += 1
    except InputError as error:
        return _faulty_message(str(error).replace(str(path.parent), ""))
    except TooLong:
        return f"hangs for more than {LONGEST_S} s"
    except Exception:
        last = traceback.format_exc().strip().splitlines()
        frames = [line.strip() for line in last if line.startswith("  File")]
        return f"{last[-1][:200]} ({frames[-1][-120:]})"
    finally:
        signal.setitimer(signal.ITIMER_PROF, 0)
        took = time.process_time() - started
        outcome.slowest_s = max(outcome.slowest_s, took)
    return ""


def _faulty_message(text: str) -> str:
    if "unexpected error" in text or "Traceback" in text:
        return f"message: {text[:200]}"
    if "\n" in text or not text.isprintable():
        return f"message of several lines: {text[:200]!r}"
    if len(text) > MESSAGE:
        return f"message of {len(text)} characters: {text[:200]}"
    return ""


def reached() -> set[str]:
    """Return the functions of the package that read sound files: "module:name"."""
    found = set()

    def record(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and "/clerestory/" in frame.f_code.co_filename:
            module = frame.f_globals.get("__name__", "")
            found.add(f"{module}:{frame.f_code.co_qualname}")

    warnings.simplefilter("ignore")
    for reader in READERS.values():
        with tempfile.TemporaryDirectory() as place:
            seeds, read = reader.seeds(Path(place)), reader.called()
            path = Path(place, reader.file)
            for seed in seeds:
                path.write_bytes(seed)
                sys.setprofile(record)
                read(path)
                sys.setprofile(None)
    return found


def main() -> None:
    """Run the mutants of readers and print the outcomes."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("readers", nargs="*", metavar="READER", help=", ".join(READERS))
    parser.add_argument("--count", type=int, default=1000)
    parser.add_argument("--first", type=int, default=0)
    parser.add_argument("--keep", type=Path, help="folder for the mutants with defects")
    parser.add_argument(
        "--reached", action="store_true", help="print functions that seeds reach"
    )
    parser.add_argument("--names", action="store_true", help="print the readers")
    parser.add_argument("--asked", action="store_true", help="readers from stdin")
    given = parser.parse_args()
    if given.reached:
        sys.stdout.write(json.dumps(sorted(reached())))
        return
    if given.names:
        sys.stdout.write(json.dumps(list(READERS)))
        return
    for reader in READERS.values():
        reader.called()
    asked = (line.strip() for line in iter(sys.stdin.readline, ""))
    for name in asked if given.asked else given.readers or READERS:
        outcome = run(name, given.count, first=given.first, keep=given.keep)
        sys.stdout.write(json.dumps(asdict(outcome)) + "\n")
        sys.stdout.flush()


if __name__ == "__main__":
    main()
