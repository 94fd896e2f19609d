"""Scanner for the text of tensor trees: braces and numbers.

The text, which can have hundreds of megabytes, is scanned in chunks to save memory.
"""

import warnings
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Float32, Int8, Int32, UInt8

_CHUNK = 1 << 22  # chunk size [bytes]

_SPACE, _WORD, _OPEN, _CLOSE = range(4)
_KIND = np.full(256, _WORD, dtype=np.uint8)
_KIND[list(b" \t\r\n\f\v,")] = _SPACE
_KIND[ord("{")], _KIND[ord("}")] = _OPEN, _CLOSE
_TO_SPACES = bytes.maketrans(b"{},", b"   ")


@dataclass(frozen=True, eq=False)
class TreeScan:
    """Braces and values of a text, in text order."""

    step: Int8[np.ndarray, " braces"]  # +1 for an opening, −1 for a closing brace
    # Number of words between the previous brace and each brace
    words: Int32[np.ndarray, " braces"]
    values: Float32[np.ndarray, " values"]  # all words as numbers


class TreeFault(Exception):
    """Error in the text of a tree, located by the index of a brace or a byte offset."""

    def __init__(self, message: str, *, brace: int = -1, offset: int = -1) -> None:
        super().__init__(message)
        self.message, self.brace, self.offset = message, brace, offset


def position_of(text: bytes, fault: TreeFault) -> int:
    """Offset of an error in the text [bytes]."""
    if fault.brace < 0:
        return max(fault.offset, 0)
    seen = 0
    for start in range(0, len(text), _CHUNK):
        kind = _KIND[np.frombuffer(text[start : start + _CHUNK], dtype=np.uint8)]
        braces = np.flatnonzero(kind >= _OPEN)
        if fault.brace < seen + len(braces):
            return start + int(braces[fault.brace - seen])
        seen += len(braces)
    return len(text)


def scan_tree(text: bytes) -> TreeScan:
    """Extract the braces and values of a text.

    >>> scan = scan_tree(b"{ { 0.5 } { 1 2 } }")
    >>> scan.step.tolist(), scan.words.tolist(), scan.values.tolist()
    ([1, 1, -1, 1, -1, -1], [0, 0, 1, 0, 2, 0], [0.5, 1.0, 2.0])
    """
    steps, words, values = [], [], []
    carried, start = 0, 0
    while start < len(text):
        end = _end_of_word(text, start + _CHUNK)
        chunk = text[start:end]
        kind: UInt8[np.ndarray, " bytes"] = _KIND[np.frombuffer(chunk, dtype=np.uint8)]
        word = kind == _WORD
        begins = np.flatnonzero(word & ~np.concatenate([[False], word[:-1]]))
        braces = np.flatnonzero(kind >= _OPEN)

        # Count the words since the previous brace
        before = np.searchsorted(begins, braces)
        count = np.diff(before, prepend=0)
        if len(count):
            count[0] += carried
            carried = len(begins) - int(before[-1])
        else:
            carried += len(begins)
        steps.append(np.where(kind[braces] == _OPEN, 1, -1).astype(np.int8))
        words.append(count.astype(np.int32))
        values.append(_numbers(chunk, len(begins), start))
        start = end
    if carried:
        message = "values after the last brace of a tensor tree; end of text expected"
        raise TreeFault(message, offset=len(text))
    if not any(len(step) for step in steps):
        raise TreeFault("no tensor tree; text in braces {…} expected")
    return TreeScan(
        np.concatenate(steps), np.concatenate(words), np.concatenate(values)
    )


def _end_of_word(text: bytes, end: int) -> int:
    # Move back to the start of a word; words of over 100 bytes are cut and rejected
    end = min(end, len(text))
    for back in range(min(end, 100)):
        if end == len(text) or _KIND[text[end - back]] != _WORD:
            return end - back if end - back > 0 else end
    return end


def _numbers(chunk: bytes, count: int, offset: int) -> Float32[np.ndarray, " values"]:
    plain = chunk.translate(_TO_SPACES)
    if not count:
        return np.empty(0, dtype=np.float32)
    try:
        with np.errstate(over="ignore"):
            single = parse_numbers(plain.decode("ascii")).astype(np.float32)
    except ValueError as error:
        raise _bad_word(plain, offset) from error
    if len(single) != count or not np.all(np.isfinite(single)):
        raise _bad_word(plain, offset)
    return single


def parse_numbers(text: str) -> Float[np.ndarray, " numbers"]:
    """Numbers separated by white space; raise ValueError for other words."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            return np.fromstring(text, sep=" ")
    except DeprecationWarning as error:
        raise ValueError(str(error)) from error


def _bad_word(plain: bytes, offset: int) -> TreeFault:
    # Find the first word that is not a finite number
    place = 0
    for word in plain.split():
        place = plain.index(word, place)
        if not _is_finite(word):
            shown = word[:40].decode("latin-1")
            message = f"{shown!r} in a tensor tree; a finite number expected"
            return TreeFault(message, offset=offset + place)
        place += len(word)
    message = "unreadable values in a tensor tree; numbers expected"
    return TreeFault(message, offset=offset)


def _is_finite(word: bytes) -> bool:
    try:
        with np.errstate(over="ignore"):
            return bool(np.isfinite(np.float32(float(word)))) and b"_" not in word
    except ValueError:
        return False
