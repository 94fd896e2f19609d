"""Short representations of values in notebooks and at the prompt: one line each.

Arrays are shown by type and shape, collections by size, values within values by type.
"""

from collections.abc import Mapping
from dataclasses import MISSING, Field, fields, is_dataclass

import numpy as np

# Largest number of elements shown of an array or collection; largest text length
_SHOWN, _LONGEST = 4, 60


def brief(value: object) -> str:
    """Return one line of text for a dataclass; fields with default values are omitted.

    Used as `__repr__ = brief`.
    """
    known = [f for f in fields(value) if f.repr]  # type: ignore[arg-type]
    parts = [
        f"{f.name}={_short(getattr(value, f.name))}"
        for f in known
        if not _is_default(f, getattr(value, f.name))
    ]
    return f"{type(value).__name__}({', '.join(parts)})"


def _is_default(known: "Field[object]", value: object) -> bool:
    scalar = isinstance(value, str | float | int | tuple | None)
    return known.default is not MISSING and scalar and bool(value == known.default)


def _short(value: object) -> str:
    match value:
        case np.ndarray() if value.ndim < 2 and value.size <= _SHOWN:
            return str(value.tolist())
        case np.ndarray():
            return f"<{value.dtype} {' × '.join(map(str, value.shape))}>"
        case Mapping():
            shown = [_short(key) for key in list(value)[:_SHOWN]]
            more = [f"… {len(value)} in all"] if len(value) > _SHOWN else []
            return f"{{{', '.join([*shown, *more])}}}"
        case tuple() | list() if len(value) > _SHOWN or any(map(is_dataclass, value)):
            kinds = {type(item).__name__ for item in value}
            return f"<{len(value)} {' and '.join(sorted(kinds)[:_SHOWN])}>"
        case tuple() | list():
            shown = [_short(item) for item in value]
            return f"({', '.join(shown)}{',' * (len(value) == 1)})"
        case _ if is_dataclass(value) and not isinstance(value, type):
            name = getattr(value, "name", "")
            inside = repr(name) if isinstance(name, str) and name else "…"
            return f"{type(value).__name__}({inside})"
    text = repr(value)
    kind = f"<{type(value).__name__}>"
    if not isinstance(value, str) and (len(text) > _LONGEST or "\n" in text):
        return kind
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…'"
