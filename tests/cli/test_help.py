"""What the program says about itself."""

import importlib
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
    "doctor",
    "metrics",
    "compare",
    "import",
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


def test_the_version_is_told(call):
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


def test_help_loads_neither_numpy_nor_the_packages_of_a_command():
    """Help took three seconds of processor when it loaded what commands use."""
    code = (
        "import sys; from clerestory.cli.main import main;"
        "main(['--help']); main(['bsdf', 'generate', '--help']);"
        "print('loaded:', *{n.split('.')[0] for n in sys.modules},"
        " *{n for n in sys.modules if n.startswith('clerestory.')})"
    )
    child = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True
    )
    loaded = set(child.stdout.rpartition("loaded:")[2].split())
    needless = {"numpy", "xarray", "scipy", "matplotlib", "clerestory.bsdfgen.generate"}
    assert not loaded & needless


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
