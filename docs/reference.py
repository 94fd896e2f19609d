"""Pages of the reference: public names with their docstrings, by subject.

Public are the names of `clerestory` itself, and those that pages of the documentation
import from its modules.
"""

import ast
import importlib
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import clerestory

# Title and summary of each page, and the packages whose names it lists
_PAGES = (
    ("studies", "Studies", "Annual simulations described by one file.", ("study",)),
    (
        "scenes",
        "Scenes",
        "Rooms, windows, sensors, views, luminaires.",
        ("scene", "formats", "radiance"),
    ),
    (
        "bsdfs",
        "BSDFs",
        "Scattering of layers: read, measured, generated, stacked.",
        ("bsdf", "library", "gonio", "bsdfgen", "glazing", "hemisphere"),
    ),
    ("skies", "Weather and skies", "Weather files, sky matrices, suns.", ("sky",)),
    (
        "matrices",
        "Matrices and tracing",
        "Traced transfer matrices, rendering, effort, bands.",
        ("bands", "spectral", "colorimetry", "matrix", "phases", "cluster", "engine"),
    ),
    (
        "pictures",
        "Pictures and glare",
        "Pictures of radiance and glare indices.",
        ("image", "glare"),
    ),
    (
        "judging",
        "Control, metrics, comparison",
        "Shading control, metrics, comparison with measurements.",
        ("control", "metrics", "comparison", "report"),
    ),
    ("errors", "Errors", "Exceptions and warnings.", ("errors",)),
)


# Top-level modules of values that many subjects share stand with the first
_SHARED = {"directions": "scene", "spectra": "scene"}

_BLOCK = re.compile(r"^```python\n(.*?)^```$", re.MULTILINE | re.DOTALL)


def imported_names(page: Path) -> Iterator[tuple[str, str]]:
    """Yield module and name of what the Python blocks of a page import from us.

    Imported modules are left out.
    """
    for block in _BLOCK.findall(page.read_text(encoding="utf-8")):
        for node in ast.walk(ast.parse(block)):
            module = getattr(node, "module", None) or ""
            if isinstance(node, ast.ImportFrom) and module.startswith("clerestory."):
                home = importlib.import_module(module)
                names = [alias.name for alias in node.names]
                values = [getattr(home, name, inspect) for name in names]
                for name, value in zip(names, values, strict=True):
                    if not inspect.ismodule(value):
                        yield module, name


def write_reference(folder: Path) -> None:
    """Write a page for each subject and an index; every public name has its place.

    Raises
    ------
    ValueError : a public name of a package without a page
    """
    folder.mkdir(exist_ok=True)
    names = _names_by_package()
    for file, title, words, packages in _PAGES:
        found = [n for package in packages for n in names.pop(package, [])]
        _write(folder / f"{file}.rst", _page(title, words, found))
    if names:
        raise ValueError(f"no page of the reference for {names}")
    files = "".join(f"   {page[0]}\n" for page in _PAGES)
    head = _heading("Reference")
    intro = (
        "All public names, as in ``import clerestory as cl``. Shapes stand in square"
        " brackets, units too. `Conventions <../conventions.html>`__ says which side"
        " is the front and where patch 1 lies.\n\n"
    )
    _write(folder / "index.rst", f"{head}{intro}.. toctree::\n\n{files}")


def _names_by_package() -> dict[str, list[tuple[str, str]]]:
    # Module and name of what each package lists: public names first
    public = clerestory._HOME
    named = [("clerestory", name) for name in sorted(public)]
    homes = {name: f"clerestory.{home}" for name, home in public.items()}
    pages = [Path(__file__).parents[1] / "README.md"]
    pages += Path(__file__).parent.rglob("*.md")
    for home, name in sorted({each for page in pages for each in imported_names(page)}):
        if homes.get(name) != home:
            named.append((home, name))
    found: dict[str, list[tuple[str, str]]] = {}
    for home, name in named:
        package = (homes[name] if home == "clerestory" else home).split(".")[1]
        found.setdefault(_SHARED.get(package, package), []).append((home, name))
    return found


def _page(title: str, words: str, names: list[tuple[str, str]]) -> str:
    parts = [_heading(title), f"{words}\n\n.. py:currentmodule:: clerestory\n\n"]
    for home, name in names:
        value = getattr(importlib.import_module(home), name)
        kind = "class" if inspect.isclass(value) else "function"
        kind = kind if callable(value) else "data"
        members = "   :members:\n" if kind == "class" else ""
        parts.append(f".. auto{kind}:: {home}.{name}\n{members}\n")
    return "".join(parts)


def _heading(title: str) -> str:
    return f"{title}\n{'=' * len(title)}\n\n"


def _write(file: Path, text: str) -> None:
    # Untouched pages are not built again
    if not file.is_file() or file.read_text(encoding="utf-8") != text:
        file.write_text(text, encoding="utf-8")
