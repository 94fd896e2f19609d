"""Variants of a study: `[[variant]]` and `[sweep]` of the study file.

Each `[[variant]]` has a name and any keys of the study, which it overrides; the study
without overrides is the variant "base". The axes of `[sweep]` are lists: of values of a
key of the study, of values for `{name}` in its texts, or of tables with a name and any
keys. Every combination of the axes is a variant.
"""

import itertools
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NamedTuple

from clerestory.brief_repr import brief
from clerestory.checks import distinct, require
from clerestory.documents import toml_tables, validated
from clerestory.engine.device import Device
from clerestory.errors import InputError
from clerestory.escaping import printable
from clerestory.files import read_text
from clerestory.study.config import LISTED, SWEPT, Study, with_title
from clerestory.study.overrides import LinedTables, are_tables
from clerestory.toml_lines import KeyPath, key_lines, line_of

BASE = "base"

# Largest number of variants of a study
MOST_VARIANTS = 1000


@dataclass(frozen=True)
class Variant:
    """Variant of a study; `settings` has the value of each axis of a sweep, in words.

    The only variant of a study without variants has the name "".
    """

    name: str
    study: Study
    settings: Mapping[str, str] = field(default_factory=dict)

    __repr__ = brief

    def with_trace(
        self,
        *,
        seed: int | None = None,
        device: Device | None = None,
        cluster: str | None = None,
    ) -> "Variant":
        """Return a copy with another seed, compute device or cluster, unless None."""
        study = self.study.with_trace(seed=seed, device=device, cluster=cluster)
        return replace(self, study=study)


class _Tables(NamedTuple):
    # Tables of a variant before validation
    name: str
    content: LinedTables
    settings: Mapping[str, str]


class _Option(NamedTuple):
    # Value of an axis: its label, and an override or the value for `{axis}`
    label: str
    change: LinedTables
    word: str | float | None = None


class _Axis(NamedTuple):
    name: str
    options: list[_Option]


def read_variants(path: str | Path) -> tuple[Variant, ...]:
    """Read a study file and all its variants, the first of them for comparisons.

    Raises
    ------
    InputError : as for `read_study`; the message has the line and the variant
    """
    path = Path(path)
    text = read_text(path)
    whole = LinedTables(toml_tables(text, file=path), key_lines(text))
    try:
        made = list(_variants(whole))
        distinct((each.name for each in made), "variants")
    except InputError as error:
        key = LISTED if LISTED in whole.tables else SWEPT
        line = error.line or line_of((key,), whole.lines)
        raise InputError(error.message, file=path, line=line) from error
    return tuple(_validated(each, path) for each in made)


def _validated(made: _Tables, path: Path) -> Variant:
    content = made.content
    try:
        study = validated(
            content.tables,
            Study,
            file=path,
            context={"folder": path.parent},
            lines=content.lines,
        )
    except InputError as error:
        where = f'variant "{printable(made.name)}": ' if made.name else ""
        message = where + error.message
        raise InputError(message, file=path, line=error.line) from error
    return Variant(made.name, with_title(study, path), made.settings)


def _variants(whole: LinedTables) -> Iterator[_Tables]:
    own = {k: v for k, v in whole.tables.items() if k not in (LISTED, SWEPT)}
    base = LinedTables(own, whole.lines)
    require(
        len(whole.tables) - len(own) < 2,
        "both [[variant]] and [sweep]; one of them expected",
    )
    if LISTED in whole.tables:
        yield _Tables(BASE, base, {})
        yield from _listed(base, whole)
    elif SWEPT in whole.tables:
        yield from _swept(base, list(_axes(whole)))
    else:
        yield _Tables("", base, {})


def _listed(base: LinedTables, whole: LinedTables) -> Iterator[_Tables]:
    listed = whole.tables[LISTED]
    _expect(whole, are_tables(listed), (LISTED,), "tables [[variant]]")
    for number in range(len(listed)):
        name, change = _named(whole, (LISTED, number))
        yield _Tables(name, base.overridden(change), {})


def _swept(base: LinedTables, axes: list[_Axis]) -> Iterator[_Tables]:
    require(axes, "[sweep] has no axis; a list of values expected")
    count = math.prod(len(axis.options) for axis in axes)
    found = f"[sweep] has {count:,} combinations"
    require(count <= MOST_VARIANTS, f"{found}; at most {MOST_VARIANTS:,} expected")
    for chosen in itertools.product(*(axis.options for axis in axes)):
        made, words, settings = base, dict[str, str | float](), dict[str, str]()
        for axis, option in zip(axes, chosen, strict=True):
            made = made.overridden(option.change)
            settings[axis.name] = option.label
            if option.word is not None:
                words[axis.name] = option.word
        name = ", ".join(_shown(axis, label) for axis, label in settings.items())
        yield _Tables(name, made.replaced(words), settings)


def _shown(axis: str, label: str) -> str:
    # A number is shown with the name of its axis
    number = label.replace(".", "").replace("-", "").isdigit()
    return f"{axis} {label}" if number else label


def _axes(whole: LinedTables) -> Iterator[_Axis]:
    swept = whole.tables[SWEPT]
    _expect(whole, isinstance(swept, dict), (SWEPT,), "a table [sweep]")
    keys = {own.alias or name for name, own in Study.model_fields.items()}
    for key, value in swept.items():
        if key in keys:
            yield from _of_key(whole, value, (key,))
            continue
        _expect_list(whole, value, (key,))
        if are_tables(value):
            found = [_named(whole, (SWEPT, key, n)) for n in range(len(value))]
            yield _Axis(key, [_Option(*own) for own in found])
        else:
            yield _Axis(key, _words(whole, key))


def _of_key(whole: LinedTables, value: Any, path: tuple[str, ...]) -> Iterator[_Axis]:
    # One axis for each list in the tables of a key of the study
    if isinstance(value, dict):
        for key, inner in value.items():
            yield from _of_key(whole, inner, (*path, key))
        return
    _expect_list(whole, value, path)
    options = [
        _Option(label, whole.part(SWEPT, *path, number, at=path))
        for number, label in enumerate(_labels(value))
    ]
    yield _Axis(".".join(path), options)


def _words(whole: LinedTables, axis: str) -> list[_Option]:
    # Values for `{axis}` in the texts of the study and of its overrides
    values, nothing = whole.tables[SWEPT][axis], LinedTables({}, {})
    _expect(
        whole,
        all(isinstance(v, str | int | float) for v in values),
        (SWEPT, axis),
        "a list of numbers or texts",
    )
    _expect(
        whole,
        whole.mentions(axis),
        (SWEPT, axis),
        f'a key of the study, or a text of the study with "{{{axis}}}"',
    )
    labels = _labels(values)
    return [_Option(own, nothing, v) for own, v in zip(labels, values, strict=True)]


def _named(whole: LinedTables, path: KeyPath) -> tuple[str, LinedTables]:
    # Name of a table of overrides, and the other keys
    change = whole.part(*path)
    name = change.tables.get("name")
    valid = isinstance(name, str) and name and name.isprintable()
    _expect(whole, valid, (*path, "name"), "a name in quotes")
    own = {key: value for key, value in change.tables.items() if key != "name"}
    return str(name), LinedTables(own, change.lines)


def _labels(values: list[Any]) -> list[str]:
    # Values in words: what differs between lists, and the stems of file names
    lists = [value if isinstance(value, list) else [value] for value in values]
    common = [one for one in lists[0] if all(one in other for other in lists)]
    found = []
    for own, value in zip(lists, values, strict=True):
        shown = [one for one in own if one not in common] or own
        words = shown if isinstance(value, list) else [value]
        found.append(" + ".join(printable(_stem(word)) for word in words))
    return found


def _stem(word: Any) -> str:
    stem, dot, suffix = str(word).rpartition(".")
    file = isinstance(word, str) and dot and suffix.isalpha()
    return Path(stem).name if file else str(word)


def _expect_list(whole: LinedTables, value: Any, path: tuple[str, ...]) -> None:
    listed = isinstance(value, list) and value
    _expect(whole, listed, (SWEPT, *path), "a list of values")


def _expect(whole: LinedTables, valid: object, path: KeyPath, expected: str) -> None:
    # Require a condition on the value at a path
    if not valid:
        place = ".".join(
            str(part + 1) if isinstance(part, int) else printable(part) for part in path
        )
        line = line_of(path, whole.lines)
        raise InputError(f"{place} is not valid; {expected} expected", line=line)
