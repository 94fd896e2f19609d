"""Excel 97 workbooks of one sheet, as small as the format allows.

Reference: Microsoft, [MS-XLS] and [MS-CFB]: records, and the compound file around them.
"""

import struct
from collections.abc import Mapping, Sequence

_SECTOR, _END, _FREE = 512, 0xFFFFFFFE, 0xFFFFFFFF
_BOF, _EOF, _SHEET, _NUMBER, _LABEL = 0x809, 0x0A, 0x85, 0x203, 0x204


def workbook(rows: Mapping[str, Sequence[float]]) -> bytes:
    """Return a workbook with a name and numbers in each row."""
    cells = [_record(_BOF, struct.pack("<HHHHII", 0x600, 0x10, 0, 1997, 0, 6))]
    for row, (name, values) in enumerate(rows.items()):
        text = struct.pack("<HHHHB", row, 0, 0, len(name), 0) + name.encode()
        cells.append(_record(_LABEL, text))
        for column, value in enumerate(values, 1):
            cells.append(_record(_NUMBER, struct.pack("<HHHd", row, column, 0, value)))
    head = _record(_BOF, struct.pack("<HHHHII", 0x600, 5, 0, 1997, 0, 6))
    start = len(head) + 4 + 8 + 6 + 4
    sheet = struct.pack("<IHBB", start, 0, 6, 0) + b"Sheet1"
    globals_ = head + _record(_SHEET, sheet) + _record(_EOF, b"")
    return _compound(globals_ + b"".join(cells) + _record(_EOF, b""))


def _record(kind: int, data: bytes) -> bytes:
    return struct.pack("<HH", kind, len(data)) + data


def _compound(stream: bytes) -> bytes:
    # Sector 0 is the allocation table, 1 the directory; the stream follows
    stream = stream.ljust(4096, b"\0")
    count = -(-len(stream) // _SECTOR)
    chain = [0xFFFFFFFD, _END, *range(3, count + 2), _END]
    table = struct.pack(f"<{len(chain)}I", *chain).ljust(_SECTOR, b"\xff")
    head = struct.pack(
        "<8s16x5H6x", b"\xd0\xcf\x11\xe0\xa1\xb1\x1a\xe1", 62, 3, 0xFFFE, 9, 6
    )
    head += struct.pack("<9I", 0, 1, 1, 0, 4096, _END, 0, _END, 0)
    head += struct.pack("<I", 0).ljust(436, b"\xff")
    entries = _entry("Root Entry", 5, 1, _END, 0) + _entry(
        "Workbook", 2, _FREE, 2, len(stream)
    )
    directory = entries.ljust(_SECTOR, b"\0")
    return head + table + directory + stream.ljust(count * _SECTOR, b"\0")


def _entry(name: str, kind: int, child: int, start: int, size: int) -> bytes:
    text = name.encode("utf-16-le")
    data = text.ljust(64, b"\0") + struct.pack("<HBB", len(text) + 2, kind, 1)
    data += struct.pack("<III", _FREE, _FREE, child) + bytes(36)
    return data + struct.pack("<III", start, size, 0)
