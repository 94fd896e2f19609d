"""Keys of the study files in which finished runs differ."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

# Keys that do not change results, or that name runs
_LEFT_OUT = ("title", "report", "output", "optimise", "trace.device", "trace.memory_gb")

# Largest number of keys, and of characters of a value
_MOST_KEYS, _MOST_LETTERS = 8, 60


def compared_settings(
    studies: Sequence[Mapping[str, Any]],
) -> list[dict[str, str]]:
    """Return, for each study, the values of the keys in which the studies differ.

    Tables of a list are named by their key `name`, or their number. Of paths the last
    part is given; of more than eight keys, the first eight.

    >>> compared_settings([{"sky": {"rotation_deg": 0.0}}, {"sky": {}}])
    [{'sky.rotation_deg': '0'}, {'sky.rotation_deg': '–'}]
    """
    flat = [dict(_flat(study)) for study in studies]
    keys = dict.fromkeys(key for study in flat for key in study)
    shown = [
        key
        for key in keys
        if not any(key == out or key.startswith(f"{out}.") for out in _LEFT_OUT)
        and len({study.get(key) for study in flat}) > 1
    ]
    return [{key: study.get(key, "–") for key in shown[:_MOST_KEYS]} for study in flat]


def _flat(value: Any, key: str = "") -> Iterator[tuple[str, str]]:
    # Values as text by their dotted keys
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _flat(item, f"{key}.{name}" if key else str(name))
    elif isinstance(value, list) and value and isinstance(value[0], Mapping):
        for number, item in enumerate(value, start=1):
            yield from _flat(item, f"{key}.{item.get('name') or number}")
    elif value is not None and value != []:
        yield key, _words(value)


def _words(value: Any) -> str:
    if isinstance(value, list):
        words = ", ".join(_words(item) for item in value)
    elif isinstance(value, bool):
        words = "yes" if value else "no"
    elif isinstance(value, float):
        words = f"{value:g}"
    else:
        words = str(value)
        if "/" in words:
            words = PurePath(words).name or words
    short = len(words) <= _MOST_LETTERS
    return words if short else f"{words[: _MOST_LETTERS - 1]}…"
