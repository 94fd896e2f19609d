"""List of the public interface: Python names, commands with their options, study keys.

    python scripts/list_interface.py > after.txt
    git worktree add ../before v0.1.0
    PYTHONPATH=../before/src python scripts/list_interface.py > before.txt
    diff before.txt after.txt

One line for each name, sorted within its section, so that `diff` shows what a change
adds to the interface or takes away from it.
"""

import inspect
import sys
from collections.abc import Iterator
from typing import Any

import typer

import clerestory
from clerestory.study.config import Study

try:
    from clerestory.cli.program import program

    app = program()
except ImportError:  # before version 0.2
    from clerestory.cli.main import app


def python_names() -> Iterator[str]:
    """Public names; functions with the names of their parameters."""
    for name in clerestory.__all__:
        value = getattr(clerestory, name)
        text = f"python {name}"
        if inspect.isfunction(value):
            text += f"({', '.join(inspect.signature(value).parameters)})"
        yield text


def commands(command: Any, path: str) -> Iterator[str]:
    """Commands below a group, and the parameters of each."""
    for name, inner in sorted(getattr(command, "commands", {}).items()):
        yield f"command {path} {name}"
        yield from commands(inner, f"{path} {name}")
    for parameter in command.params:
        names = "/".join([*parameter.opts, *parameter.secondary_opts])
        yield f"option {path} {names} default={parameter.default!r}"


def study_keys(schema: dict[str, Any], node: Any, path: str) -> Iterator[str]:
    """Keys of a table of the study file, from its JSON schema."""
    if isinstance(node, list):
        for item in node:
            yield from study_keys(schema, item, path)
        return
    if "$ref" in node:
        node = schema["$defs"][node["$ref"].rsplit("/", 1)[-1]]
    for key, inner in sorted(node.get("properties", {}).items()):
        yield f"study {path}{key}"
        yield from study_keys(schema, inner, f"{path}{key}.")
    for kind in ("anyOf", "oneOf", "allOf"):
        yield from study_keys(schema, node.get(kind, []), path)
    if "items" in node:
        yield from study_keys(schema, node["items"], path)


def main() -> None:
    """Print all three sections."""
    schema = Study.model_json_schema()
    program = typer.main.get_command(app)
    for section in (
        python_names(),
        commands(program, "clerestory"),
        study_keys(schema, schema, ""),
    ):
        sys.stdout.writelines(f"{line}\n" for line in sorted(set(section)))


if __name__ == "__main__":
    main()
