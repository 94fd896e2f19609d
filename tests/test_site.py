"""The documentation site builds without warnings and holds every public name."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import clerestory

pytest.importorskip("furo", reason="the site needs the extra `docs`")
pytest.importorskip("myst_parser", reason="the site needs the extra `docs`")
inventory = pytest.importorskip("sphinx.util.inventory")

DOCS = Path(__file__).parents[1] / "docs"
sys.path.insert(0, str(DOCS))

from reference import imported_names


@pytest.fixture(scope="module")
def site(tmp_path_factory):
    """Folder of the site, built with warnings as errors."""
    folder = tmp_path_factory.mktemp("site")
    command = [sys.executable, "-m", "sphinx", "-W", "--keep-going", "-q", "-b", "html"]
    done = subprocess.run(
        [*command, str(DOCS), str(folder)],
        capture_output=True,
        text=True,
        check=False,
        env={**os.environ, "LC_ALL": "C.UTF-8"},
    )
    assert done.returncode == 0, done.stderr
    return folder


@pytest.mark.slow
def test_every_public_name_stands_in_the_reference(site):
    with (site / "objects.inv").open("rb") as stream:
        found = inventory.InventoryFile.load(stream, "", os.path.join)
    kinds = "class", "function", "data", "exception"
    known = set().union(*(found.get(f"py:{kind}", {}) for kind in kinds))
    public = {f"clerestory.{name}" for name in clerestory.__all__} - {
        "clerestory.__version__"
    }
    assert public <= known


@pytest.mark.slow
def test_names_that_pages_import_stand_in_the_reference(site):
    with (site / "objects.inv").open("rb") as stream:
        found = inventory.InventoryFile.load(stream, "", os.path.join)
    known = {name for kind in found if kind.startswith("py:") for name in found[kind]}
    for page in [DOCS.parent / "README.md", *DOCS.rglob("*.md")]:
        for home, name in imported_names(page):
            short = f"clerestory.{name}" in known
            assert short or f"{home}.{name}" in known, f"{page}: {name}"


@pytest.mark.slow
def test_every_page_is_built_and_none_links_out_of_the_site(site):
    pages = {path.relative_to(DOCS).with_suffix(".html") for path in DOCS.rglob("*.md")}
    for page in pages:
        text = (site / page).read_text(encoding="utf-8")
        assert 'href="../README' not in text
    index = (site / "index.html").read_text(encoding="utf-8")
    for page in pages - {Path("index.html")}:
        if page.parent == Path():
            assert f'href="{page}"' in index
