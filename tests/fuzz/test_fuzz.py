"""Every reader refuses or reads damaged files: no traceback, hang or gigabyte."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from readers import READERS

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
