"""Files that a study names, and hashes of their content."""

from collections.abc import Iterator, Mapping
from hashlib import sha256
from pathlib import Path
from typing import Any

from pydantic import BaseModel

from clerestory.files import read_bytes
from clerestory.library.bsdf_source import is_library_name
from clerestory.study.config import Study


def content_hashes(study: Study) -> dict[str, str]:
    """Return the SHA-256 hash of every file that a study names, by its path.

    Paths are those of `Study.facts`. Files that scene files name are not among them,
    nor are BSDFs of the built-in library.
    """
    return {
        study.relative(path): sha256(read_bytes(path)).hexdigest()
        for path in _paths(dict(study))
    }


def _paths(value: Any) -> Iterator[Path]:
    if isinstance(value, Path):
        if not is_library_name(value):
            yield value
    elif isinstance(value, BaseModel):
        yield from _paths(dict(value))
    elif isinstance(value, Mapping | list):
        for part in value.values() if isinstance(value, Mapping) else value:
            yield from _paths(part)
