#!/usr/bin/env python3
"""Record the sources of the estimators, and raise their revision if they changed.

    scripts/record_revision.py

Stored matrices are found again by the revision among other things, so that a matrix
traced by other code is not used. A test compares the digest with the sources. Comments,
docstrings and layout do not count.
"""

import ast
import hashlib
import re
from pathlib import Path

PACKAGE = Path(__file__).parents[1] / "src/clerestory"
RECORD = PACKAGE / "engine/revision.py"

# Modules that traced matrices depend on
SOURCES = (
    "engine/**/*.py",
    "glare/*point*.py",
    "glare/cell_luminance.py",
    "glare/d[gi]*.py",
    "glare/eye_directions.py",
    "glare/position_index.py",
    "glare/representative_steps.py",
    "glare/sphere_*.py",
    "hemisphere/*.py",
    "phases/*_matrices.py",
    "phases/*_coefficients.py",
    "phases/direct_light.py",
    "phases/exit_cells.py",
    "phases/rendering.py",
    "phases/sky_views.py",
    "phases/stored_views.py",
    "phases/sunlit.py",
    "phases/unscattered_light.py",
    "phases/window_paths.py",
    "scene/window_zones.py",
    "scene/materials/*.py",
    "scene/tessellate.py",
    "scene/triangulate.py",
)
OTHERS = {"cost_estimate", "device", "probe", "revision", "scene_cache"}


def digest() -> str:
    """Return the SHA-256 of the code of all sources."""
    paths = {path for pattern in SOURCES for path in PACKAGE.glob(pattern)}
    total = hashlib.sha256()
    for path in sorted(path for path in paths if path.stem not in OTHERS):
        total.update(path.relative_to(PACKAGE).as_posix().encode())
        total.update(normal(ast.parse(path.read_text(encoding="utf-8"))).encode())
    return total.hexdigest()


def normal(node: object) -> str:
    """Return the code of a syntax tree, without docstrings.

    Empty fields are left out: they differ between versions of Python.

    >>> normal(ast.parse('x = 1  # one')) == normal(ast.parse('x=1'))
    True
    """
    if isinstance(node, list):
        return f"[{','.join(map(normal, node))}]"
    if not isinstance(node, ast.AST):
        return repr(node)
    named = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
    if isinstance(node, named) and ast.get_docstring(node) is not None:
        node.body = node.body[1:]
    kept = {
        name: value for name, value in ast.iter_fields(node) if value not in (None, [])
    }
    inside = ",".join(f"{name}={normal(value)}" for name, value in kept.items())
    return f"{type(node).__name__}({inside})"


def record() -> None:
    """Write the digest, and the next revision if it is another one."""
    text, found = RECORD.read_text(encoding="utf-8"), digest()
    if f'"{found}"' in text:
        print("the sources of the estimators are as recorded")  # noqa: T201
        return
    text = re.sub(r'DIGEST = "[0-9a-f]*"', f'DIGEST = "{found}"', text)
    text = re.sub(
        r"REVISION = (\d+)", lambda old: f"REVISION = {int(old[1]) + 1}", text
    )
    RECORD.write_text(text, encoding="utf-8")
    print(f"{RECORD}: the next revision of the estimators")  # noqa: T201


if __name__ == "__main__":
    record()
