"""Keys of the study files in which finished runs differ."""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import PurePath
from typing import Any

# Keys that do not change results, or that name runs
_LEFT_OUT = ("title", "report", "output", "optimise", "trace.device", "trace.memory_gb")

# Largest number of keys, and of characters of a value
_MOST_KEYS, _MOST_LETTERS = 8, 60

# Digits of a hash that are shown
_DIGITS = 6


def compared_settings(
    studies: Sequence[Mapping[str, Any]],
    files: Sequence[Mapping[str, str]] | None = None,
) -> list[dict[str, str]]:
    """Return, for each study, the values of the keys in which the studies differ.

    Tables of a list are named by their key `name`, or their number. Of paths the last
    part is given; of more than eight keys, the first eight. `files` are hashes of the
    content of input files by path, for each study: if names are equal and content is
    not, the files that differ are given with the first digits of their hashes.

    >>> compared_settings([{"sky": {"rotation_deg": 0.0}}, {"sky": {}}])
    [{'sky.rotation_deg': '0'}, {'sky.rotation_deg': '–'}]
    >>> study = {"weather": {"file": "oslo.epw"}}
    >>> compared_settings([study] * 2, [{"oslo.epw": "3fe1a2"}, {"oslo.epw": "90c4b7"}])
    [{'weather.file': 'oslo.epw (3fe1a2)'}, {'weather.file': 'oslo.epw (90c4b7)'}]
    """
    hashes = files or [{}] * len(studies)
    plain = [dict(_flat(study, {})) for study in studies]
    exact = [dict(_flat(*pair)) for pair in zip(studies, hashes, strict=True)]
    hashed = all(hashes)
    found: list[dict[str, str]] = [{} for _ in studies]
    for key in dict.fromkeys(key for study in plain for key in study):
        if any(key == out or key.startswith(f"{out}.") for out in _LEFT_OUT):
            continue
        values = [study.get(key, "–") for study in plain]
        # Without hashes of all files only their names can be compared
        if len(set(values)) == 1 and hashed:
            values = _without_common([study.get(key, "–") for study in exact])
        if len(set(values)) == 1:
            continue
        for study, value in zip(found, values, strict=True):
            study[key] = _shortened(value)
        if len(found[0]) == _MOST_KEYS:
            break
    return found


def _flat(
    value: Any, hashes: Mapping[str, str], key: str = ""
) -> Iterator[tuple[str, str]]:
    # Values as text by their dotted keys
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _flat(item, hashes, f"{key}.{name}" if key else str(name))
    elif isinstance(value, list) and value and isinstance(value[0], Mapping):
        for number, item in enumerate(value, start=1):
            yield from _flat(item, hashes, f"{key}.{item.get('name') or number}")
    elif value is not None and value != []:
        yield key, _words(value, hashes)


def _without_common(values: Sequence[str]) -> list[str]:
    # What lists do not have in common
    lists = [value.split(", ") for value in values]
    common = set(lists[0]).intersection(*lists[1:])
    return [", ".join(w for w in words if w not in common) for words in lists]


def _shortened(words: str) -> str:
    short = len(words) <= _MOST_LETTERS
    return words if short else f"{words[: _MOST_LETTERS - 1]}…"


def _words(value: Any, hashes: Mapping[str, str]) -> str:
    if isinstance(value, list):
        return ", ".join(_words(item, hashes) for item in value)
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:g}"
    words = str(value)
    digits = hashes.get(words, "")[:_DIGITS]
    if "/" in words:
        words = PurePath(words).name or words
    return f"{words} ({digits})" if digits else words
