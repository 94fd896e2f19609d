"""Every reader refuses or reads damaged files: no traceback, hang or gigabyte."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest
from seeds import READERS

HARNESS = Path(__file__).with_name("harness.py")


@pytest.mark.parametrize("name", READERS)
def test_damaged_files_are_refused_in_words(name, request):
    """A rotating part of 10,000 mutants a reader; `--mutants N` sets how many."""
    count = request.config.getoption("--mutants")
    first = int(os.environ.get("FUZZ_FIRST", "0"))
    command = [sys.executable, HARNESS, name, "--count", count, "--first", first]
    ran = subprocess.run(
        [str(word) for word in command],
        capture_output=True,
        text=True,
        check=False,
        timeout=600,
    )
    assert ran.returncode == 0, ran.stderr[-2000:]
    # Image libraries print warnings of their own before it
    assert json.loads(ran.stdout.splitlines()[-1])["defects"] == []
