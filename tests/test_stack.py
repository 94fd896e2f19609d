"""The packages form a stack: each may import only those on the lines before it.

Packages on one line do not import each other. The lines are those of design.md §3;
what is a data folder without Python does not count.
"""

import ast
from pathlib import Path

import pytest

import clerestory

STACK = (
    (
        "array_types",
        "brief_repr",
        "errors",
        "constants",
        "options",
        "progress",
        "threads",
        "warning_log",
    ),
    ("checks", "escaping", "argument_types"),
    ("files", "file_lock", "directions", "bands", "spectra", "toml_lines"),
    ("spectral",),
    ("colorimetry", "documents"),
    ("hemisphere",),
    ("matrix",),
    ("bsdf", "sky"),
    ("gonio", "glazing"),
    ("library",),
    ("energyplus",),
    ("scene",),
    ("formats",),
    ("radiance",),
    ("image",),
    ("engine",),
    ("cluster",),
    ("bsdfgen", "phases"),
    ("glare", "control", "metrics", "uncertainty"),
    ("study",),
    ("comparison", "compat", "recipes"),
    ("report",),
    ("cli",),
)
TRACERS = {"mitsuba", "drjit"}

ROOT = Path(clerestory.__file__).parent
# What really stands in the source folder, modules and packages
REAL = sorted(
    path.stem
    for path in ROOT.iterdir()
    if (path.suffix == ".py" and path.stem != "__init__")
    or (path.is_dir() and any(path.rglob("*.py")))
)


def python_files(package):
    single = ROOT / f"{package}.py"
    return [single] if single.is_file() else sorted((ROOT / package).rglob("*.py"))


def imported_modules(file):
    """Dotted names that a file imports, anywhere in it."""
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)
        elif isinstance(node, ast.ImportFrom):
            assert node.level == 0, f"{file} has a relative import"
            yield node.module
            # `from clerestory import cli` names a package behind the import
            if node.module == "clerestory":
                yield from (f"clerestory.{alias.name}" for alias in node.names)


def imported_packages(file):
    """Packages of ours that a file imports."""
    for name in imported_modules(file):
        parts = name.split(".")
        if parts[0] == "clerestory" and len(parts) > 1 and parts[1] != "__version__":
            yield parts[1]


def line_of(package):
    return next(i for i, line in enumerate(STACK) if package in line)


@pytest.mark.parametrize("package", REAL)
def test_package_has_its_place_in_the_stack(package):
    assert any(package in line for line in STACK), f"no place for {package}"


@pytest.mark.parametrize("package", REAL)
def test_imports_point_down(package):
    for file in python_files(package):
        for used in set(imported_packages(file)) - {package}:
            assert line_of(used) < line_of(package), (
                f"{file.relative_to(ROOT)} imports {used} from above or beside"
            )


def test_root_imports_nothing_of_its_own():
    """Names are provided on demand, so that the import is fast."""
    assert not list(imported_packages(ROOT / "__init__.py"))


def test_only_the_engine_imports_the_tracer():
    for package in set(REAL) - {"engine"}:
        for file in python_files(package):
            roots = {name.split(".")[0] for name in imported_modules(file)}
            assert not roots & TRACERS, f"{file.relative_to(ROOT)} imports a tracer"


def test_an_upward_import_is_seen(tmp_path):
    """The test itself: every way to write an import is understood."""
    file = tmp_path / "upward.py"
    file.write_text(
        "import clerestory.cli.main\n"
        "from clerestory import report\n"
        "def late():\n"
        "    from clerestory.study.study_run import run_study\n"
    )
    assert set(imported_packages(file)) == {"cli", "report", "study"}
