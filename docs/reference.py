"""Pages of the reference: every public name with its docstring, by subject."""

import inspect
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
        ("bsdf", "gonio", "bsdfgen", "glazing", "hemisphere"),
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


def _names_by_package() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for name in clerestory.__all__:
        if name != "__version__":
            home = inspect.getmodule(getattr(clerestory, name))
            package = home.__name__.split(".")[1]
            found.setdefault(package, []).append(name)
    return found


def _page(title: str, words: str, names: list[str]) -> str:
    parts = [_heading(title), f"{words}\n\n.. py:currentmodule:: clerestory\n\n"]
    for name in names:
        if inspect.isclass(getattr(clerestory, name)):
            parts.append(f".. autoclass:: clerestory.{name}\n   :members:\n\n")
        else:
            parts.append(f".. autofunction:: clerestory.{name}\n\n")
    return "".join(parts)


def _heading(title: str) -> str:
    return f"{title}\n{'=' * len(title)}\n\n"


def _write(file: Path, text: str) -> None:
    # Untouched pages are not built again
    if not file.is_file() or file.read_text(encoding="utf-8") != text:
        file.write_text(text, encoding="utf-8")
