"""Every reader refuses or reads damaged files: no traceback, hang or gigabyte."""

import ast
import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from readers import READERS

import clerestory

SOURCE = Path(clerestory.__file__).parent

# Calls by which bytes come in, and names of functions that read what came in
CALLS = {"read_bytes", "read_text", "open_workbook", "open_dataset", "File"}
NAMES = ("read_", "parse_")

# Functions that are not fuzzed
LEFT_OUT = {
    "compat.genskyvec:genskyvec": "reads by read_rad",
    "recipes.visualization:_values": "reads what it has written",
    "spectral.colour_rendering:_functions": "reads files of the package",
    "control.control_rule:load_rule": "runs a Python program of the user",
    "glazing.standard:_table": "reads files of the package",
    "phases.illuminance:illuminance": "reads what it has written",
    "phases.hourly_file:read_hourly": "reads what it has written",
    "study.results:_append_hourly": "writes",
    "study.results:_describe_hourly": "writes",
    "study.results:_variables": "reads what it has written",
    "study.annual_view_grids:_hourly_file": "writes",
    "study.illuminance_by_state:results_by_state": "reads what it has written",
    "study.annual_view_grids:study_view_grids": "reads what it has written",
    "study.view_grid_positions:read_view_grid": "reads by read_positions",
    "report.page_assets:asset": "reads files of the package",
    "spectral.functions:spectral_function": "reads files of the package",
    "spectral.material_library:material_samples": "reads files of the package",
    "study.variant_run:_input_key": "hashes what other readers read",
    "study.input_files:content_hashes": "hashes what other readers read",
    "energyplus.engine_run:convert_to_json": "the engine reads the file",
    "energyplus.engine_run:simulate": "reads what the engine has written",
    "energyplus.engine_run:_reason": "reads what the engine has written",
    "energyplus.engine_process:simulate": "reads what this package has written",
    "study.new_study:_replace_blind": "reads what it has written",
    "cli.compat:_picture": "copies standard input to a file, which is then read",
    "study.new_study:write_demo": "copies files of the package",
}

HARNESS = Path(__file__).with_name("harness.py")


@pytest.fixture(scope="module")
def harness(request):
    """A process that has imported the package, and forks another for each reader."""
    options = request.config.getoption
    first = os.environ.get("FUZZ_FIRST", "0")
    words = ["--asked", "--count", options("--mutants"), "--first", first]
    with subprocess.Popen(
        [str(word) for word in (sys.executable, HARNESS, *words)],
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
        text=True,
    ) as server:
        yield server
        server.stdin.close()


@pytest.mark.parametrize("name", READERS)
def test_damaged_files_are_refused_in_words(name, harness):
    """`--mutants N` sets how many; the first one is $FUZZ_FIRST."""
    harness.stdin.write(f"{name}\n")
    harness.stdin.flush()
    outcome = json.loads(harness.stdout.readline())
    assert outcome["reader"] == name
    assert outcome["defects"] == []


def entries():
    """Functions of the package through which bytes from outside come in."""
    for file in SOURCE.rglob("*.py"):
        module = ".".join(file.relative_to(SOURCE).with_suffix("").parts)
        module = module.removesuffix(".__init__")
        for node in ast.parse(file.read_text("utf-8")).body:
            if isinstance(node, ast.FunctionDef):
                called = {
                    _name(n.func) for n in ast.walk(node) if isinstance(n, ast.Call)
                }
                calls = called & CALLS and not node.name.startswith("write_")
                if node.name.startswith(NAMES) or calls:
                    yield f"{module}:{node.name}"


def _name(called):
    return getattr(called, "id", "") or getattr(called, "attr", "")


def test_every_reader_is_fuzzed():
    """Sound files reach all functions that read files or are called read_…, parse_…."""
    words = [sys.executable, HARNESS, "--reached"]
    ran = subprocess.run(words, capture_output=True, text=True, check=True)
    reached = {name.removeprefix("clerestory.") for name in json.loads(ran.stdout)}
    assert sorted(set(entries()) - reached - LEFT_OUT.keys()) == []
