"""What the program says about itself."""

import importlib
import resource
import subprocess
import sys
from typing import get_args

import pytest

import clerestory
from clerestory.engine.device import Finding

COMMANDS = [
    "new",
    "run",
    "demo",
    "report",
    "view",
    "doctor",
    "metrics",
    "compare",
    "import",
    "recipe",
    "multiply",
    "irradiance",
    "glare",
    "picture merge",
    "picture reproject",
    "picture calibrate",
    "trace view",
    "trace daylight",
    "trace facade",
    "trace coefficients",
    "sky matrix",
    "sky sun",
    "sky describe",
    "bsdf info",
    "bsdf check",
    "bsdf plot",
    "bsdf compare",
    "bsdf view",
    "bsdf insert",
    "bsdf convert",
    "bsdf reduce",
    "glazing stack",
    "glazing info",
    "gonio info",
    "gonio fit",
    "gonio check",
    "gonio export",
    "gonio plot",
]


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_has_help_with_an_example(call, command):
    outcome = call(*command.split(), "--help")
    assert outcome.status == 0
    assert f"Example: clerestory {command}" in " ".join(outcome.out.split())


@pytest.mark.parametrize("command", [[], ["trace"], ["sky"], ["bsdf"]])
def test_a_bare_group_lists_its_commands(call, command):
    outcome = call(*command)
    assert "Commands" in outcome.out + outcome.err
    assert outcome.status == 2


def test_the_version_is_reported(call):
    outcome = call("--version")
    assert outcome.out == f"clerestory {clerestory.__version__}\n"
    assert outcome.status == 0


def test_the_command_line_starts_without_mitsuba():
    code = (
        "import sys, clerestory.cli.main;"
        "print([m for m in ('mitsuba', 'drjit') if m in sys.modules])"
    )
    child = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    assert child.stdout.strip() == "[]"


def test_doctor_fails_when_something_is_broken(call, monkeypatch):
    findings = [Finding("LLVM", "libLLVM.so.23: works", True)]
    monkeypatch.setattr("clerestory.cli.doctor.describe", lambda: findings)
    assert call("doctor").status == 0
    findings.append(Finding("CUDA", "driver too old", False))
    outcome = call("doctor")
    assert outcome.status == 1
    assert "FAIL  CUDA  driver too old" in outcome.out


def test_units_in_brackets_are_shown(call):
    assert "[sr]" in call("trace", "view", "--help").out


def test_no_help_loads_numpy_or_the_packages_of_a_command():
    """Help took three seconds of processor when it loaded what commands use.

    All commands and groups; without these packages, each takes 0.1 to 0.4 s.
    """
    code = """
import sys
from clerestory.cli import program
from clerestory.cli.command import commands_of
from clerestory.cli.main import main

groups = {g: commands_of(program._requests(g)) for g in program._GROUPS}
words = [[], *([name] for name in program._TOP), *([g] for g in groups)]
words += [[g, name] for g, commands in groups.items() for name in commands]
status = [main([*each, "--help"]) for each in words]
loaded = {n for n in sys.modules if n.startswith("clerestory.")}
loaded |= {n.split(".")[0] for n in sys.modules}
print("loaded:", len(words), sum(status), *loaded)
"""
    child = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    count, status, *loaded = child.stdout.rpartition("loaded:")[2].split()
    assert int(count) > 60
    assert status == "0"
    slow = {"numpy", "xarray", "scipy", "matplotlib", "pandas", "mitsuba", "drjit"}
    assert not slow & set(loaded)


@pytest.mark.parametrize("word", ["--help", "--version"])
def test_help_and_version_need_little_processor_time(word):
    """Measured 0.2 and 0.06 s; three times as much is left for slow machines."""
    code = "import sys; from clerestory.cli.main import main; main(sys.argv[1:])"
    command = [sys.executable, "-c", code, word]
    taken = []
    for _ in range(3):
        before = resource.getrusage(resource.RUSAGE_CHILDREN)
        subprocess.run(command, capture_output=True, check=True)
        after = resource.getrusage(resource.RUSAGE_CHILDREN)
        taken.append(after.ru_utime + after.ru_stime)
        taken[-1] -= before.ru_utime + before.ru_stime
    assert min(taken) < 0.9


@pytest.mark.parametrize(
    ("ours", "theirs"),
    [
        ("common:Device", "engine.device:Device"),
        ("common:Encoding", "matrix.radiance_format:Encoding"),
        ("common:Function", "bsdf.scattering_function:Function"),
        ("gonio:Symmetry", "gonio.symmetry:Symmetry"),
        ("picture:Mapping", "image.fisheye_lens:Mapping"),
    ],
)
def test_choices_are_those_of_the_packages(ours, theirs):
    """Requests name choices themselves, so that help need not load the packages."""

    def choices(place, root):
        module, _, name = place.partition(":")
        return get_args(getattr(importlib.import_module(f"{root}.{module}"), name))

    ours, theirs = (
        choices(ours, "clerestory.cli.requests"),
        choices(theirs, "clerestory"),
    )
    assert ours == theirs
