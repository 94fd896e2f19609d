"""Sphinx builds the site from the pages of this folder: `scripts/docs`.

The pages stay plain Markdown that reads well without it. The reference is made anew
from the public names and their docstrings at each build.
"""

import re
import sys
from pathlib import Path

import clerestory

sys.path.insert(0, str(Path(__file__).parent))

from docstrings import convert
from reference import write_reference

HERE = Path(__file__).parent

project = "Clerestory"
author = "The Clerestory engineers"
copyright = author
version = release = clerestory.__version__

extensions = [
    "myst_parser",
    "sphinx.ext.autodoc",
    "mathml",
]
html_math_renderer = "mathml"
source_suffix = {".md": "markdown", ".rst": "restructuredtext"}
exclude_patterns = ["_build"]
root_doc = "index"

# Markdown: heading anchors as on code hosts, formulas, indexes of pages
myst_enable_extensions = ["dollarmath", "colon_fence"]
myst_heading_anchors = 3

# Words in backquotes are code; that some are also names of several things is no fault
suppress_warnings = ["myst.header", "misc.highlighting_failure", "ref.python"]

# Docstrings tell meanings, units and shapes; signatures stay short
autodoc_typehints = "none"
autodoc_member_order = "bysource"
default_role = "code"
python_use_unqualified_type_names = True

# The theme; nothing is fetched from other hosts
html_theme = "furo"
html_title = f"Clerestory {release}"
html_show_sourcelink = False
html_static_path: list[str] = []

# Links out of this folder become words, but for what the site shows as pages
_ELSEWHERE = re.compile(
    r"\[([^\]]+)\]\(\.\./(?!docs|[\w-]+\.md|[\w-]+/[\w-]+\.md)[^)]*\)"
)
_SHOWN = {
    "readme": "README.md",
    "changelog": "CHANGELOG.md",
    "contributing": "CONTRIBUTING.md",
}


def _within_site(_app: object, page: str, source: list[str]) -> None:
    # Files of the repository's root are pages here, and name pages as from there
    if page in _SHOWN:
        text = (HERE.parent / _SHOWN[page]).read_text(encoding="utf-8")
        text = text.replace("](docs/", "](").replace("](LICENSE)", "](../LICENSE)")
        for name, file in _SHOWN.items():
            text = text.replace(f"]({file}", f"]({name}.md")
    else:
        text = source[0]
        for name, file in _SHOWN.items():
            text = text.replace(f"](../{file}", f"]({name}.md")
    source[0] = _ELSEWHERE.sub(r"\1", text)


def setup(app: object) -> None:
    """Write the reference, and keep links within the site."""
    write_reference(HERE / "reference")
    app.connect("source-read", _within_site)
    app.connect("autodoc-process-docstring", convert)
