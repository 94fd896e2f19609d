"""Random damage to files: bytes, words, numbers, lines and nested blocks.

Every mutant depends on its number alone, so a failure can be repeated.
"""

import re

import numpy as np

# Values that numbers and words are replaced by
NUMBERS = [
    *(b"nan", b"inf", b"-inf", b"-1", b"-0.5", b"0", b"1e999", b"1e-999", b"1e38"),
    *(b"1e11", b"1e9", b"999999999999", b"4294967296", b"2147483648", b"-2147483648"),
    *(b"0x1p3", b"1_0", b"1,5", b"9" * 5000, b"1e", b"--1", b"+", b".", b"\xd9\xa3"),
]
TEXTS = [
    *(b"{", b"}", b"[", b"]", b"(", b")", b"<", b">", b'"', b"'", b"\\", b"#", b"!"),
    *(b",", b";", b":", b"=", b"|", b"&", b"$", b"%s", b"\t", b"\n", b"\r", b"\0"),
    *(b"\xff\xfe", b"\xef\xbb\xbf", b"\xc3", "\u202e".encode(), "\u00b2".encode()),
    *(b"null", b"true", b"{}", b"[]", b'""', b"a" * 600, b"../x", b"/dev/null", b"."),
    *(b"<!DOCTYPE a [<!ENTITY x 'y'><!ENTITY z '&x;&x;'>]>", b"<![CDATA[", b"]]>"),
    *(b"xform -a 99999999 -t 1 0 0", b"-a 1000 -t 1 0 0 -a 1000 -t 0 1 0"),
]
NUMBER = re.compile(rb"[-+]?\d+\.?\d*(?:[eE][-+]?\d+)?")
WORD = re.compile(rb"[A-Za-z_][\w.-]*")
PAIRS = [(b"{", b"}"), (b"[", b"]"), (b"(", b")")]


def mutant(seeds: list[bytes], number: int) -> bytes:
    """Return seed file `number` modulo their count, with one to four faults."""
    rng = np.random.default_rng(number)
    data = seeds[number % len(seeds)]
    for _ in range(rng.integers(1, 5)):
        data = FAULTS[rng.integers(len(FAULTS))](data, rng)
    return data[: 1 << 22]


def _choice(values: list[bytes], rng: np.random.Generator) -> bytes:
    return values[rng.integers(len(values))]


def _place(data: bytes, rng: np.random.Generator) -> tuple[int, int]:
    # Headers are short and decide much: half of the faults are near the start
    end = len(data) if rng.random() < 0.5 else min(len(data), 400)
    return int(rng.integers(end + 1)), int(rng.exponential(12)) + 1


def _flip(data: bytes, rng: np.random.Generator) -> bytes:
    at, _ = _place(data, rng)
    return data[:at] + rng.bytes(1) + data[at + 1 :]


def _delete(data: bytes, rng: np.random.Generator) -> bytes:
    at, size = _place(data, rng)
    return data[:at] + data[at + size :]


def _repeat(data: bytes, rng: np.random.Generator) -> bytes:
    at, size = _place(data, rng)
    times = int(rng.choice([1, 2, 50, 2000]))
    return data[:at] + data[at : at + size] * times + data[at:]


def _insert(data: bytes, rng: np.random.Generator) -> bytes:
    at, _ = _place(data, rng)
    return data[:at] + _choice(TEXTS, rng) + data[at:]


def _truncate(data: bytes, rng: np.random.Generator) -> bytes:
    at, _ = _place(data, rng)
    return data[:at] if rng.random() < 0.3 else data


def _number(data: bytes, rng: np.random.Generator) -> bytes:
    return _replaced(data, NUMBER, _choice(NUMBERS, rng), rng)


def _word(data: bytes, rng: np.random.Generator) -> bytes:
    other = WORD.findall(data) or [b"x"]
    text = _choice(other if rng.random() < 0.5 else TEXTS, rng)
    return _replaced(data, WORD, text, rng)


def _replaced(
    data: bytes, pattern: re.Pattern[bytes], text: bytes, rng: np.random.Generator
) -> bytes:
    found = pattern.search(data, _place(data, rng)[0])
    if found is None:
        return data
    return data[: found.start()] + text + data[found.end() :]


def _line(data: bytes, rng: np.random.Generator) -> bytes:
    # Delete, double, move or merge lines
    lines = data.split(b"\n")
    at, other = (int(rng.integers(len(lines))) for _ in range(2))
    match rng.integers(4):
        case 0:
            del lines[at]
        case 1:
            lines.insert(other, lines[at])
        case 2:
            lines[at], lines[other] = lines[other], lines[at]
        case _:
            lines[at : at + 2] = [b" ".join(lines[at : at + 2])]
    return b"\n".join(lines)


def _nest(data: bytes, rng: np.random.Generator) -> bytes:
    # Nest a place deeply, or as often as a hostile file would
    at, _ = _place(data, rng)
    opening, closing = PAIRS[rng.integers(len(PAIRS))]
    depth = int(rng.choice([1, 20, 3000]))
    inside = data[at : at + 1]
    return data[:at] + opening * depth + inside + closing * depth + data[at + 1 :]


FAULTS = [
    *(_flip, _delete, _repeat, _insert, _truncate, _number, _number, _word, _line),
    _nest,
]
