"""PDF file of a report, printed by a Chromium browser without a window."""

import os
import shutil
import subprocess
import tempfile
from pathlib import Path

from clerestory.checks import require
from clerestory.errors import OutputError
from clerestory.files import is_file, replace_path

# Programs and usual places of Chromium, Chrome and Edge
_PROGRAMS = (
    *("chromium", "chromium-browser", "google-chrome", "google-chrome-stable"),
    *("chrome", "microsoft-edge", "msedge"),
)
_PLACES = (
    "/Applications/Chromium.app/Contents/MacOS/Chromium",
    "/Applications/Google Chrome.app/Contents/MacOS/Google Chrome",
    "C:/Program Files/Google/Chrome/Application/chrome.exe",
    "C:/Program Files (x86)/Microsoft/Edge/Application/msedge.exe",
)
_OPTIONS = (
    *("--headless", "--disable-gpu", "--no-first-run", "--disable-extensions"),
    *("--disable-background-networking", "--no-pdf-header-footer"),
    "--virtual-time-budget=10000",
)

# Longest time for printing [s]
_LONGEST = 180


def find_browser() -> str:
    """Return the path of a Chromium, Chrome or Edge browser.

    Raises
    ------
    OutputError : none is installed
    """
    found = [path for path in map(shutil.which, _PROGRAMS) if path]
    found += [path for path in _PLACES if is_file(path)]
    if not found:
        raise OutputError(
            "a PDF needs Chromium, Chrome or Edge, and none was found; install one, or"
            " open the report in a browser and print it"
        )
    return found[0]


def write_pdf(page: str | Path, path: str | Path) -> None:
    """Print an HTML page to a PDF file.

    Raises
    ------
    InputError : the page does not exist
    OutputError : no browser is installed, or it does not write the file
    """
    page = Path(page)
    require(is_file(page), "does not exist; a page expected", file=page)
    browser = find_browser()
    # Browsers refuse to run as root inside their sandbox
    root = hasattr(os, "geteuid") and os.geteuid() == 0
    with (
        replace_path(path) as file,
        tempfile.TemporaryDirectory(ignore_cleanup_errors=True) as profile,
    ):
        command = [
            *(browser, *_OPTIONS, *(("--no-sandbox",) if root else ())),
            *(f"--user-data-dir={profile}", f"--print-to-pdf={file.resolve()}"),
            page.resolve().as_uri(),
        ]
        problem = _run(command)
        if not file.read_bytes().startswith(b"%PDF"):
            raise OutputError(f"{path}: {browser} wrote no PDF: {problem}")


def _run(command: list[str]) -> str:
    # Run a command; return its last message
    try:
        done = subprocess.run(
            command, capture_output=True, timeout=_LONGEST, check=False
        )
    except subprocess.TimeoutExpired:
        return f"it did not finish in {_LONGEST} s"
    except OSError as error:
        return error.strerror or str(error)
    lines = done.stderr.decode(errors="replace").strip().splitlines()
    return lines[-1] if lines else f"exit status {done.returncode}"
