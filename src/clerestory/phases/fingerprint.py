"""One short text for everything a traced matrix depends on.

Two values have the same fingerprint when all that matters in them is equal. What
does not matter is where an item stands in a file: fields named `source` are left
out, so that a comment added above a wall does not trace the wall again.
"""

import hashlib
import struct
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from typing import Any

import numpy as np

_IRRELEVANT_FIELDS = frozenset({"source"})


def fingerprint(*values: Any) -> str:
    """Return the SHA-256 of values, as 64 hexadecimal digits.

    Parameters
    ----------
    values : frozen dataclasses, arrays, numbers, texts, None, and tuples, lists
        or mappings of these

    Raises
    ------
    TypeError : a value of another kind, whose content cannot be told

    Examples
    --------
    >>> fingerprint(1, "a") == fingerprint(1, "a"), fingerprint(1) == fingerprint(1.0)
    (True, False)
    """
    digest = hashlib.sha256()
    for piece in _pieces(values):
        digest.update(piece)
    return digest.hexdigest()


def _pieces(value: Any) -> Iterator[bytes]:
    # Every piece opens with its kind and length, so that no two values run together
    if value is None:
        yield b"none;"
    elif isinstance(value, bool | np.bool_):
        yield b"bool:%d;" % value
    elif isinstance(value, int | np.integer):
        yield b"int:%d;" % value
    elif isinstance(value, float | np.floating):
        yield b"float:" + struct.pack("<d", float(value) + 0.0)
    elif isinstance(value, str):
        text = value.encode("utf-8", "surrogatepass")
        yield b"text%d:" % len(text) + text
    elif isinstance(value, bytes):
        yield b"bytes%d:" % len(value) + value
    elif isinstance(value, np.ndarray):
        yield from _array_pieces(value)
    elif isinstance(value, Mapping):
        yield b"mapping%d:" % len(value)
        for key in sorted(value):
            yield from _pieces((key, value[key]))
    elif isinstance(value, tuple | list):
        yield b"sequence%d:" % len(value)
        for item in value:
            yield from _pieces(item)
    elif is_dataclass(value) and not isinstance(value, type):
        yield from _record_pieces(value)
    else:
        raise TypeError(f"a {type(value).__name__} has no fingerprint")


def _array_pieces(array: np.ndarray) -> Iterator[bytes]:
    if array.dtype.hasobject:
        raise TypeError("an array of objects has no fingerprint")
    little = np.ascontiguousarray(array, dtype=array.dtype.newbyteorder("<"))
    yield f"array{little.dtype.str}{array.shape}:".encode()
    yield little.tobytes()


def _record_pieces(record: Any) -> Iterator[bytes]:
    yield from _pieces(type(record).__qualname__)
    for item in fields(record):
        if item.name not in _IRRELEVANT_FIELDS:
            yield from _pieces((item.name, getattr(record, item.name)))
