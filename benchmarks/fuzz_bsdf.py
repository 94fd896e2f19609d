"""Damaged BSDF files by the thousand: none may crash, hang, eat memory or slip NaN in.

Small files of every kind are damaged at random, in their bytes, words and elements, and
read. A file is either refused with an `InputError` or it is a sound BSDF: its values
are finite, it can be evaluated, integrated and written. Each piece of the run is a
process of its own with limited memory.

    python benchmarks/fuzz_bsdf.py --count 100000 -o docs/benchmarks/bsdf-fuzz.md
"""

import argparse
import contextlib
import json
import re
import resource
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from dataclasses import asdict, dataclass, field, replace
from datetime import UTC, datetime
from pathlib import Path

import numpy as np

from clerestory.bsdf.analytic import thin_pane
from clerestory.bsdf.product_data import Geometry, Product
from clerestory.bsdf.resample import to_trees
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import ClerestoryWarning, InputError
from clerestory.hemisphere.klems import from_rings
from clerestory.radiance.bsdf_package import layer_geometry

HERE = Path(__file__).parent
SEEDS = HERE.parent / "tests" / "data"

PIECE = 2000  # files a process
LONGEST = 10  # seconds a file may take before it counts as hanging
MEMORY = 3 << 30  # bytes of address space of a process
LARGEST = 60_000  # bytes of files taken from a folder of one's own

MGF = (
    "m white =\n\trd 0.7\nv a =\n\tp 0 0 0\n\tn 0 0 1\nxf -a 3 -t 0 0 1\nsph a 1\nxf\n"
)

TOKENS = [
    *(b"nan", b"inf", b"-inf", b"-1", b"-0.5", b"0", b"1e999", b"1e-999", b"1e38"),
    *(b"999999999999", b"4294967296", b"2147483648", b"-2147483648", b"0x1p3", b"1_0"),
    *(b"{", b"}", b"{ {", b"} }", b"{ 1 2 }", b",", b"\t", b"\n", b"\0", b"\xff\xfe"),
    *(b"<", b">", b"</", b"/>", b"&", b"&lt;", b"&#0;", b"&x;", b"]]>", b"<![CDATA["),
    *(b"<!--", b"-->", b"<?xml version='1.0' encoding='utf-16'?>", b"xmlns='y'"),
    b"<!DOCTYPE a [<!ENTITY x 'yyyy'><!ENTITY z '&x;&x;&x;&x;'>]>",
    *(b"TensorTree3", b"TensorTree4", b"Columns", b"Rows", b"Transmission Back"),
    *(b"LBNL/Klems Full", b"LBNL/Klems Half", b"LBNL/Shirley-Chiu", b"CIE-u", b"IR"),
    *(b"<nPhis>1000000000</nPhis>", b"<ScatteringData>", b"</ScatteringData>"),
    *(b"xf -a 99999999 -t 1 0 0\n", b"xf\n", b"-i 99999999", b"torus a 0 1\n"),
]

PLAIN = [t for t in TOKENS if not set(t) & set(b"<>&\0\xff")]
WORD = re.compile(rb"[\s,{>]([^\s,{}<>]+)(?=[^<>]*</)")
ELEMENT = re.compile(rb"<(\w+)[^<>]*>(?:[^<]|<(?!/\1>))*?</\1>\s*")


@dataclass
class Outcome:
    """What became of a number of files."""

    files: int = 0
    loaded: int = 0
    crashes: list[str] = field(default_factory=list)
    hangs: int = 0
    slowest_s: float = 0.0
    peak_mb: float = 0.0

    def add(self, other: "Outcome") -> None:
        """Take in another piece."""
        self.files += other.files
        self.loaded += other.loaded
        self.crashes += other.crashes
        self.hangs += other.hangs
        self.slowest_s = max(self.slowest_s, other.slowest_s)
        self.peak_mb = max(self.peak_mb, other.peak_mb)


class _TooLong(Exception):
    pass


def seeds(folder: Path | None, place: Path) -> list[bytes]:
    """Sound files: matrices and trees of both ranks, with geometry and without."""
    rings = from_rings(
        "Few", limits_deg=np.array([0.0, 30, 90]), count=np.array([1, 4])
    )
    pane = replace(
        thin_pane(0.9, rings),
        product=Product("Pane", "Nobody", "Other", 0.01, 1, 2, geometry=Geometry(MGF)),
    )
    write_bsdf(place / "matrix.xml", pane)
    write_bsdf(place / "tree4.xml", to_trees(pane, halvings=2), digits=3)
    files = [*SEEDS.glob("*.xml"), place / "matrix.xml", place / "tree4.xml"]
    data = [file.read_bytes() for file in files]
    tree3 = data[-1].replace(b"TensorTree4", b"TensorTree3")
    cells = (
        b"{ { 0.1 } { 0.2 } { .1 .2 .3 .4 .5 .6 .7 .8 } { 0 } { 1 } { 2 } { 3 } { 4 } }"
    )
    start = tree3.index(b"<ScatteringData>") + len(b"<ScatteringData>")
    data.append(tree3[:start] + cells + tree3[tree3.index(b"</ScatteringData>") :])
    rows = data[-3].replace(b">Columns<", b">Rows<")
    more = sorted(folder.rglob("*.xml")) if folder else []
    small = [file.read_bytes() for file in more if file.stat().st_size < LARGEST]
    return [*data, rows, *small]


def damaged(data: bytes, rng: np.random.Generator) -> bytes:
    """Return a file with one to four faults; half of them leave the XML whole."""
    if rng.random() < 0.5:
        for _ in range(rng.integers(1, 4)):
            data = _content_changed(data, rng)
        return data
    for _ in range(rng.integers(1, 5)):
        at, size = int(rng.integers(len(data) + 1)), int(rng.exponential(12)) + 1
        token = TOKENS[rng.integers(len(TOKENS))]
        match rng.integers(8):
            case 0:
                flipped = bytes([rng.integers(256)])
                data = data[:at] + flipped + data[at + 1 :]
            case 1:
                data = data[:at] + data[at + size :]
            case 2:
                data = data[: at + size] + data[at:]
            case 3:
                data = data[:at] + token + data[at:]
            case 4:
                data = _word_replaced(data, at, token)
            case 5:
                data = _element_changed(data, at, rng)
            case 6:
                data = data[:at] if rng.random() < 0.3 else data[: at + 40 * size]
            case _:
                other = int(rng.integers(len(data) + 1))
                data = data[:at] + data[other : other + 20 * size] + data[at + size :]
    return data


def _content_changed(data: bytes, rng: np.random.Generator) -> bytes:
    # Change, add or drop a word of a text, or double, drop or move a whole element
    at = int(rng.integers(len(data)))
    token = PLAIN[rng.integers(len(PLAIN))]
    if rng.random() < 0.6:
        found = WORD.search(data, data.find(b">", at))
        if found is None:
            return data
        start, end = found.span(1)
        word = [token, b"", data[start:end] + b" " + token][rng.integers(3)]
        return data[:start] + word + data[end:]
    found = ELEMENT.search(data, at)
    if found is None:
        return data
    start, end = found.span()
    element = found[0] * int(rng.integers(0, 3))
    return data[:start] + element + data[end:]


def _word_replaced(data: bytes, at: int, token: bytes) -> bytes:
    # Put a token in the place of the word or number that stands there
    start = max(data.rfind(c, 0, at) for c in (b" ", b">", b"\n", b",", b'"'))
    ends = [data.find(c, at) for c in (b" ", b"<", b"\n", b",", b'"')]
    end = min((e for e in ends if e >= 0), default=len(data))
    return data[: start + 1] + token + data[end:]


def _element_changed(data: bytes, at: int, rng: np.random.Generator) -> bytes:
    # Leave an element out, or give it twice
    start = data.rfind(b"<", 0, at)
    end = data.find(b">", at)
    if start < 0 or end < 0:
        return data
    element = data[start : end + 1]
    return data[:start] + element * int(rng.integers(0, 3)) + data[end + 1 :]


def judge(path: Path, *, write: bool) -> bool:
    """Read a file; return whether it loaded, and assert that it is sound then."""
    try:
        bsdf = read_bsdf(path)
    except InputError:
        return False
    rng = np.random.default_rng(1)
    incident, leaving = rng.normal(size=(2, 16, 3))
    incident /= np.linalg.norm(incident, axis=1, keepdims=True)
    leaving /= np.linalg.norm(leaving, axis=1, keepdims=True)
    for channel, name in bsdf.functions:
        part = bsdf.functions[channel, name]
        values = part.evaluate(incident, leaving)
        shares = part.hemispherical(incident[:4])
        for numbers in (values, shares, part.extrema()):
            assert np.all(np.isfinite(numbers)), "a value that is not finite"
            assert np.min(numbers) >= 0, "a negative value"
        if isinstance(part, ScatteringTree):
            cells = part.slots[part.slots >= 0].view(np.float32)
            assert np.all(np.isfinite(cells)), "a cell that is not finite"
    with contextlib.suppress(InputError):
        layer_geometry(bsdf)
    if write:
        write_bsdf(path.with_name("again.xml"), bsdf)
        read_bsdf(path.with_name("again.xml"))
    return True


def run_piece(first: int, count: int, folder: Path | None) -> Outcome:
    """Damage and read `count` files; file k depends on its number alone."""

    def too_long(*_: object) -> None:
        raise _TooLong

    resource.setrlimit(resource.RLIMIT_AS, (MEMORY, MEMORY))
    signal.signal(signal.SIGALRM, too_long)
    warnings.simplefilter("ignore", ClerestoryWarning)
    outcome = Outcome()
    with tempfile.TemporaryDirectory() as place:
        originals = seeds(folder, Path(place))
        path = Path(place, "damaged.xml")
        for number in range(first, first + count):
            rng = np.random.default_rng(number)
            path.write_bytes(damaged(originals[rng.integers(len(originals))], rng))
            outcome.files += 1
            started = time.perf_counter()
            signal.alarm(LONGEST)
            try:
                outcome.loaded += judge(path, write=number % 10 == 0)
            except _TooLong:
                outcome.hangs += 1
            except Exception:
                last = traceback.format_exc().strip().splitlines()
                outcome.crashes.append(f"{number}: {last[-1]} ({last[-3].strip()})")
            signal.alarm(0)
            took = time.perf_counter() - started
            outcome.slowest_s = max(outcome.slowest_s, took)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    outcome.peak_mb = peak / 1024
    return outcome


def run_pieces(count: int, folder: Path | None, state: Path | None) -> Outcome:
    """Run pieces in processes of their own, but those that a state file holds."""
    done = json.loads(state.read_text()) if state and state.exists() else {}
    total = Outcome()
    for piece in done.values():
        total.add(Outcome(**piece))
    for first in range(0, count, PIECE):
        if str(first) in done:
            continue
        size = min(PIECE, count - first)
        command = [sys.executable, __file__, "--piece", str(first), str(size)]
        command += ["--seeds", str(folder)] if folder else []
        ran = subprocess.run(command, capture_output=True, text=True, check=False)
        if ran.returncode:
            total.crashes.append(f"{first}…: {ran.returncode} {ran.stderr[-300:]}")
        else:
            done[str(first)] = json.loads(ran.stdout)
            total.add(Outcome(**done[str(first)]))
        if state:
            state.write_text(json.dumps(done))
        print(f"{total.files} files, {len(total.crashes)} crashes", file=sys.stderr)
    return total


def page(outcome: Outcome) -> str:
    """Return the result as a page of the documentation."""
    refused = outcome.files - outcome.loaded - outcome.hangs - len(outcome.crashes)
    rows = {
        "damaged files": outcome.files,
        "refused with a message": refused,
        "loaded: finite, evaluated, summed, written again": outcome.loaded,
        "crashes": len(outcome.crashes),
        f"hangs (over {LONGEST} s)": outcome.hangs,
        "slowest file": f"{outcome.slowest_s:.2f} s",
        "largest memory of a process": f"{outcome.peak_mb:.0f} MB",
    }
    table = "\n".join(f"| {name} | {value} |" for name, value in rows.items())
    return (
        "# Damaged BSDF files\n\n"
        f"Made by `benchmarks/fuzz_bsdf.py` on {datetime.now(UTC):%d %B %Y}; NumPy"
        f" {np.__version__}.\n\n| | |\n| --- | --- |\n{table}\n"
    )


def main() -> None:
    """Run the pieces, or one of them."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--count", type=int, default=100_000)
    parser.add_argument("--seeds", type=Path, help="folder with more files to damage")
    parser.add_argument("--piece", type=int, nargs=2, help=argparse.SUPPRESS)
    parser.add_argument("--state", type=Path, help="file to go on from and to keep")
    parser.add_argument("-o", "--output", type=Path)
    options = parser.parse_args()
    if options.piece:
        outcome = run_piece(*options.piece, options.seeds)
        print(json.dumps(asdict(outcome)))
        return
    outcome = run_pieces(options.count, options.seeds, options.state)
    text = page(outcome)
    if options.output:
        options.output.write_text(text, encoding="utf-8")
    print(text, *outcome.crashes, sep="\n")
    sys.exit(bool(outcome.crashes or outcome.hangs))


if __name__ == "__main__":
    main()
