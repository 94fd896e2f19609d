"""Fingerprints (hashes) of all inputs of a traced matrix.

Every fingerprint includes the version number of the tracing code. The fields `source`,
`executor` and `progress` are left out, because the line number of an object in a file
and the machine that traces the paths do not affect the matrix.
"""

import hashlib
import struct
from collections.abc import Callable, Mapping
from dataclasses import fields, is_dataclass
from functools import cache
from typing import Any

import numpy as np

from clerestory.engine.revision import ESTIMATOR_REVISION

Feed = Callable[[bytes], None]

_IRRELEVANT_FIELDS = frozenset({"source", "executor", "progress"})


def fingerprint(*values: Any) -> str:
    """Return the SHA-256 of values, as 64 hexadecimal digits.

    Values are frozen dataclasses, arrays, numbers, texts, None, and tuples, lists or
    mappings of these; any other type raises a TypeError.

    >>> fingerprint(1, "a") == fingerprint(1, "a"), fingerprint(1) == fingerprint(1.0)
    (True, False)
    """
    digest = hashlib.sha256()
    _feed((ESTIMATOR_REVISION, values), digest.update)
    return digest.hexdigest()


def _feed(value: Any, feed: Feed) -> None:
    # A prefix with type and length makes the bytes of every value unambiguous
    if isinstance(value, str):
        text = value.encode("utf-8", "surrogatepass")
        feed(b"text%d:" % len(text) + text)
    elif isinstance(value, np.ndarray):
        _feed_array(value, feed)
    elif value is None:
        feed(b"none;")
    elif isinstance(value, bool | np.bool_):
        feed(b"bool:%d;" % value)
    elif isinstance(value, int | np.integer):
        feed(b"int:%d;" % value)
    elif isinstance(value, float | np.floating):
        feed(b"float:" + struct.pack("<d", float(value) + 0.0))
    elif isinstance(value, bytes):
        feed(b"bytes%d:" % len(value) + value)
    elif isinstance(value, tuple | list):
        feed(b"sequence%d:" % len(value))
        for item in value:
            _feed(item, feed)
    elif isinstance(value, Mapping):
        feed(b"mapping%d:" % len(value))
        for key in sorted(value):
            _feed((key, value[key]), feed)
    elif is_dataclass(value) and not isinstance(value, type):
        head, names = _layout(type(value))
        feed(head)
        for name in names:
            _feed(getattr(value, name), feed)
    else:
        raise TypeError(f"values of type {type(value).__name__} have no fingerprint")


def _feed_array(array: np.ndarray, feed: Feed) -> None:
    if array.dtype.hasobject:
        raise TypeError("an array of objects has no fingerprint")
    if array.dtype.byteorder == ">":
        array = array.astype(array.dtype.newbyteorder("<"))
    feed(f"array{array.dtype.str}{array.shape}:".encode())
    feed(array.tobytes())


@cache
def _layout(record: type) -> tuple[bytes, tuple[str, ...]]:
    # Byte prefix of a dataclass, and the names of its hashed fields
    names = tuple(f.name for f in fields(record) if f.name not in _IRRELEVANT_FIELDS)
    return f"record {record.__qualname__}({', '.join(names)}):".encode(), names
