"""Run-length encoding of Radiance pictures, in the old and the new format.

In the new format, a scanline starts with the bytes 2, 2 and its length (high, low
byte). The four components of its pixels follow one after another, each as literals (a
count up to 128, then as many bytes) and runs (128 + count, then the byte to repeat).
In the old format, pixels of four bytes follow each other; the pixel 1 1 1 n repeats the
previous pixel n times. Successive repetitions give higher bytes of the count.
"""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, UInt8

from clerestory.checks import require

# Lengths of scanlines written in the new format (color.c: MINELEN, MAXELEN)
SHORTEST, LONGEST = 8, 0x7FFF

# Shortest and longest run, and longest literal
_SHORTEST_RUN, _LONGEST_RUN, _LONGEST_LITERAL = 4, 127, 128
_RUN = 128

# Number of pixels that are decoded together
_BLOCK = 1 << 20

_TRUNCATED = "damaged pixel data: the file ends within a scanline"
_TOO_LONG = "damaged pixel data: a run exceeds its scanline"

_Bytes = UInt8[np.ndarray, " bytes"]


def decode(
    data: _Bytes, *, rows: int, width: int
) -> Iterator[UInt8[np.ndarray, "rows width 4"]]:
    """Yield the four bytes of every pixel, in blocks of scanlines."""
    together = max(_BLOCK // width, 1)
    # Uncompressed pixels have four bytes each and no repetitions
    if data.size == rows * width * 4 and not _is_new(data, 0, width):
        quads = data.reshape(rows, width, 4)
        blocks = [quads[first : first + together] for first in range(0, rows, together)]
        if not any((block[..., :3] == 1).all(axis=-1).any() for block in blocks):
            yield from blocks
            return
    start = row = 0
    while row < rows:
        if _is_new(data, start, width):
            # Decode all scanlines in the new format up to the next in the old format
            arguments = data, start, rows - row, width
            found = _find_together(*arguments) or _find_in_order(*arguments)
            codes, starts, end = found
            require(end <= data.size, _TRUNCATED)
            row += len(starts)
            borders = [*starts[::together].tolist(), end]
            for first, stop in enumerate(borders[1:]):
                lines = starts[first * together : (first + 1) * together]
                low, high = np.searchsorted(codes, [start, stop])
                own = codes[low:high] - start
                yield _expand(data[start:stop], own, lines - start, width)
                start = stop
        else:
            part, start = _decode_old(data, start, width)
            row += 1
            yield part


def _is_new(data: _Bytes, start: int, width: int) -> bool:
    head = data[start : start + 4]
    if not SHORTEST <= width <= LONGEST or head.size < 4:
        return False
    if head[0] != 2 or head[1] != 2 or head[2] > 127:
        return False
    length = (int(head[2]) << 8) + int(head[3])
    require(
        length == width,
        f"damaged pixel data: a scanline of {length} pixels; {width} expected, as in"
        " the header",
    )
    return True


def _find_in_order(
    data: _Bytes, start: int, most: int, width: int
) -> tuple[np.ndarray, np.ndarray, int]:
    # Positions of count bytes and of scanlines from `start` on, and end of the last
    # scanline, by a sequential search; appended runs end the search in damaged data
    raw = data.tobytes() + bytes([255]) * 2
    head = bytes([2, 2, width >> 8, width & 255])
    codes: list[int] = []
    starts: list[int] = []
    at = start
    while len(starts) < most and raw.startswith(head, at):
        starts.append(at)
        at += 4
        left = 4 * width
        while left > 0:
            codes.append(at)
            code = raw[at] if at < len(raw) else 255
            left -= code - _RUN if code > _RUN else code
            at += 2 if code > _RUN else code + 1
        if at > data.size:
            break
    return np.array(codes, dtype=np.int64), np.array(starts, dtype=np.int64), at


def _find_together(
    data: _Bytes, start: int, most: int, width: int
) -> tuple[np.ndarray, np.ndarray, int] | None:
    # As `_find_in_order`, but in parallel from every possible start of a scanline; None
    # if there are too many possible starts, or counts of zero
    head = np.flatnonzero(data[start:-3] == 2) + start
    for i, value in enumerate((2, width >> 8, width & 255), start=1):
        head = head[data[head + i] == value]
    if head.size > 2 * most + 16:
        return None
    padded = np.append(data, np.uint8(255))
    at, left = head + 4, np.full(head.size, 4 * width)
    line = np.arange(head.size)
    end = np.full(head.size, data.size + 1)
    codes, lines = [], []
    for _ in range(4 * width):
        code = padded[np.minimum(at, data.size)].astype(np.int64)
        codes.append(at)
        lines.append(line)
        run = code > _RUN
        left = left - np.where(run, code - _RUN, code)
        at = at + np.where(run, 2, code + 1)
        busy = left > 0
        if not busy.all():
            end[line[~busy]] = at[~busy]
            at, left, line = at[busy], left[busy], line[busy]
            if not line.size:
                break
    if line.size:
        return None
    return _chain(head, end, np.concatenate(codes), np.concatenate(lines), start, most)


def _chain(
    head: np.ndarray,
    end: np.ndarray,
    codes: np.ndarray,
    lines: np.ndarray,
    start: int,
    most: int,
) -> tuple[np.ndarray, np.ndarray, int]:
    # Keep only scanlines that follow each other without gaps
    after = dict(zip(head.tolist(), range(head.size), strict=True))
    chosen: list[int] = []
    at = start
    while len(chosen) < most and at in after:
        chosen.append(after[at])
        at = int(end[chosen[-1]])
    kept = np.zeros(head.size, dtype=bool)
    kept[chosen] = True
    return np.sort(codes[kept[lines]]), head[chosen], at


def _expand(
    data: _Bytes, codes: np.ndarray, starts: np.ndarray, width: int
) -> UInt8[np.ndarray, "rows width 4"]:
    # Number of repetitions of each byte: 0 for headers and counts, 1 for literals
    times = np.ones(data.size, dtype=np.int64)
    times[starts[:, None] + np.arange(4)] = 0
    times[codes] = 0
    count = data[codes].astype(np.int64)
    run = count > _RUN
    count[run] -= _RUN
    times[codes[run] + 1] = count[run]
    # Each component must end at the end of a run or of literals
    ends = np.cumsum(count)
    borders = width * np.arange(1, 4 * starts.size + 1)
    at = np.searchsorted(ends, borders)
    require(at[-1] < ends.size and (ends[at] == borders).all(), _TOO_LONG)
    return np.repeat(data, times).reshape(starts.size, 4, width).transpose(0, 2, 1)


def _decode_old(data: _Bytes, start: int, width: int) -> tuple[np.ndarray, int]:
    # A scanline takes at most four bytes per pixel
    chunk = data[start : start + 4 * width]
    quads = chunk[: chunk.size // 4 * 4].reshape(-1, 4)
    repeat = (quads[:, :3] == 1).all(axis=1)
    # Each successive repetition pixel gives the next higher byte of the count
    index = np.arange(len(quads))
    since = index - np.maximum.accumulate(np.where(repeat, -1, index))
    shift = np.minimum(8 * (since - 1), 32)
    count = np.where(repeat, quads[:, 3].astype(np.int64) << np.maximum(shift, 0), 1)
    ends = np.cumsum(np.minimum(count, width + 1))
    last = int(np.searchsorted(ends, width))
    require(last < len(quads), _TRUNCATED)
    require(ends[last] == width and not repeat[0], _TOO_LONG)
    source = np.maximum.accumulate(np.where(repeat, -1, index))[: last + 1]
    row = np.repeat(quads[source], count[: last + 1], axis=0)
    return row[None], start + 4 * (last + 1)


def encode(pixels: UInt8[np.ndarray, "rows width 4"]) -> bytes:
    """Return scanlines in the new format, or uncompressed if too short or too long."""
    width = pixels.shape[1]
    if not SHORTEST <= width <= LONGEST:
        return pixels.tobytes()
    flat = np.ascontiguousarray(pixels.transpose(0, 2, 1)).reshape(-1)
    start, length, run = _segments(flat, width)
    # Output positions of the counts of runs and literals; scanlines start with a header
    heads = start % (4 * width) == 0
    size = np.where(run, 2, length + 1) + 4 * heads
    at = np.cumsum(size) - size + 4 * heads
    out = np.empty(int(size.sum()), dtype=np.uint8)
    literal = np.ones(out.size, dtype=bool)
    head = (at[heads] - 4)[:, None] + np.arange(4)
    out[head] = np.array([2, 2, width >> 8, width & 255], dtype=np.uint8)
    out[at] = np.where(run, _RUN + length, length)
    out[at[run] + 1] = flat[start[run]]
    literal[head] = literal[at] = literal[at[run] + 1] = False
    out[literal] = flat[np.repeat(~run, length)]
    return out.tobytes()


def _segments(
    flat: _Bytes, width: int
) -> tuple[np.ndarray, np.ndarray, Bool[np.ndarray, " pieces"]]:
    # Split runs where the byte changes, and at the ends of components
    new = np.empty(flat.size, dtype=bool)
    new[0] = True
    np.not_equal(flat[1:], flat[:-1], out=new[1:])
    new[::width] = True
    start = np.flatnonzero(new)
    run = np.diff(start, append=flat.size) >= _SHORTEST_RUN
    # Join adjacent runs that are too short into literals
    joined = ~run & ~np.append(True, run[:-1]) & (start % width != 0)
    start, run = start[~joined], run[~joined]
    length = np.diff(start, append=flat.size)
    # Split runs and literals that are too long for one count
    longest = np.where(run, _LONGEST_RUN, _LONGEST_LITERAL)
    pieces = -(-length // longest)
    within = np.arange(pieces.sum()) - np.repeat(np.cumsum(pieces) - pieces, pieces)
    offset = within * np.repeat(longest, pieces)
    return (
        np.repeat(start, pieces) + offset,
        np.minimum(np.repeat(length, pieces) - offset, np.repeat(longest, pieces)),
        np.repeat(run, pieces),
    )
