"""Runs of the tutorial's shell scripts in a copy of its folder, and their results."""

import os
import re
import resource
import shutil
import subprocess
from collections import defaultdict
from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np
import pyradiance

import clerestory
from clerestory.errors import ClerestoryError
from clerestory.image.picture_files import read_picture
from clerestory.matrix.radiance_format import read_matrix

RADIANCE = Path(pyradiance.__file__).parent

# Commands that make and read pictures of each sun
SUN_PICTURES = re.compile(
    r"^vwrays .*\| *rcontrib .*-o matrices/cds/hdr.*$"
    r"|^for idx in \{0000\.\.5185\}\ndo\n(?:.*\n)*?done$",
    re.MULTILINE,
)


@dataclass(frozen=True)
class Outcome:
    """Processor time of a script [s], its results by name, and what it reported.

    Results are matrices of sensors, and all pictures of one name but for its number.
    `code` is the version of clerestory, see `code_version`.
    """

    seconds: float
    messages: str
    code: str
    sensors: dict[str, np.ndarray] = field(default_factory=dict)
    pictures: dict[str, np.ndarray] = field(default_factory=dict)

    def write(self, path: Path) -> None:
        """Write a file, which is whole when it has its name."""
        found = {f"sensors:{name}": values for name, values in self.sensors.items()}
        found |= {f"pictures:{name}": values for name, values in self.pictures.items()}
        part = path.with_name(f"part-{path.name}")
        np.savez(
            part, seconds=self.seconds, messages=self.messages, code=self.code, **found
        )
        part.rename(path)

    @classmethod
    def read(cls, path: Path) -> "Outcome":
        """Read what `write` wrote."""
        kinds: dict[str, dict[str, np.ndarray]] = {"sensors": {}, "pictures": {}}
        with np.load(path) as found:
            for label in found.files:
                kind, _, name = label.partition(":")
                if name:
                    kinds[kind][name] = found[label]
            code = str(found["code"]) if "code" in found.files else "not recorded"
            seconds, messages = float(found["seconds"]), str(found["messages"])
            return cls(seconds, messages, code, **kinds)


def code_version() -> str:
    """Return the last commit that changed the package's sources, or its version.

    Changes that are not committed are an error: a page could not name them.
    """
    source = Path(clerestory.__file__).parent
    given = ["git", "-C", str(source)]
    run = partial(subprocess.run, check=False, capture_output=True, text=True)
    found = run([*given, "log", "-1", "--format=%h", "--", "."]).stdout.strip()
    if not found:
        return clerestory.__version__
    if run([*given, "status", "--porcelain", "--", "."]).stdout:
        raise SystemExit(f"{source} has changes that are not committed")
    return found


def numbered(name: str) -> str:
    """Return the name of a set for that of a picture with a number of four digits."""
    return re.sub(r"\d{4}\.hdr$", "%04d.hdr", name)


@dataclass(frozen=True)
class Room:
    """A copy of the tutorial's folder, in which scripts run one after the other.

    Attributes
    ----------
    path : PATH of the scripts
    rays : -ad and -c are multiplied by this
    one_process : whether -n is 1
    sun_pictures : whether pictures of each sun are made
    """

    source: Path
    folder: Path
    path: str
    rays: float = 1.0
    one_process: bool = False
    sun_pictures: bool = False

    def outcome(self, script: str) -> Outcome:
        """Run a script unless it has run, and return its results."""
        kept = self.folder.with_name(f"{self.folder.name}-{script}.npz")
        if not kept.exists():
            if not self.folder.exists():
                shutil.copytree(self.source, self.folder)
            self._run(script).write(kept)
        return Outcome.read(kept)

    def _lines(self, script: str) -> str:
        text = (self.folder / "commands" / script).read_text()
        if self.one_process:
            text = re.sub(r"-n 16\b", "-n 1", text)
        if not self.sun_pictures:
            text = SUN_PICTURES.sub("", text)
        if self.rays == 1:
            return text
        return re.sub(
            r"-(ad|c) (\d{3,})\b",
            lambda found: f"-{found[1]} {round(self.rays * int(found[2]))}",
            text,
        )

    def _run(self, script: str) -> Outcome:
        code = code_version()
        known = {path: path.stat().st_mtime_ns for path in self._files()}
        environment = {
            **os.environ,
            "PATH": self.path,
            "RAYPATH": f".:{RADIANCE / 'lib'}",
            "PYTHONPATH": str(Path(clerestory.__file__).parents[1]),
        }
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        done = subprocess.run(
            ["bash", "-c", self._lines(script)], cwd=self.folder, env=environment,
            check=False, stdin=subprocess.DEVNULL, capture_output=True, text=True,
        )  # fmt: skip
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        used = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
        new = [p for p in self._files() if p.stat().st_mtime_ns != known.get(p)]
        return Outcome(used, done.stderr, code, *self._read(new))

    def _files(self) -> Iterator[Path]:
        yield from sorted(self.folder.glob("results/**/*.ill"))
        yield from sorted(self.folder.glob("results/**/*.hdr"))

    def _read(
        self, paths: list[Path]
    ) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
        sensors, pictures = {}, defaultdict(list)
        for path in paths:
            name = str(path.relative_to(self.folder / "results"))
            try:
                if path.suffix == ".ill":
                    sensors[name] = read_matrix(path).values.ravel()
                else:
                    pictures[numbered(name)].append(read_picture(path).radiance)
            except ClerestoryError:
                # Scripts also loop over numbers that have no picture
                continue
        stacks = {name: np.array(found).ravel() for name, found in pictures.items()}
        return sensors, stacks
