"""Text files of RPC Photonics' scatterometer: one incident direction per file.

Two lines that start with !! are followed by the incident angles and by lines of θ, φ
and BSDF [1/sr]. The incident φ is the azimuth of propagation: undeviated transmission
and mirror reflection are at the incident φ. The file does not state whether values are
for reflection or for transmission.

Reference: files of the engineered diffuser EDS10 in ua-loft/bsdf-tools, and Photon
Engineering's article 304 on them.
"""

from collections.abc import Sequence
from pathlib import Path

from clerestory.errors import InputError
from clerestory.files import read_text
from clerestory.gonio.formats.file_format import FileFormat, ReadOptions
from clerestory.gonio.formats.text_tables import numbered_lines, scan_of_block
from clerestory.gonio.scattering_measurement import Measurement, Scan

_MARK = "!!"


def _read(paths: Sequence[Path], options: ReadOptions) -> tuple[Measurement, ...]:
    scans = tuple(_scan(path) for path in paths)
    head = read_text(paths[0]).lstrip(_MARK).split()
    function = options.function or "transmission_front"
    return (Measurement(scans, function, name=head[0] if head else ""),)


def _scan(path: Path) -> Scan:
    lines = numbered_lines(path)
    body = [(number, text) for number, text in lines if _MARK not in text[:2]]
    if len(body) == len(lines) or not body:
        raise InputError(
            "no line that starts with !!; a file of RPC Photonics' scatterometer"
            " expected",
            file=path,
        )
    return scan_of_block(body, path)


FORMAT = FileFormat("viavi", lambda head: head.data.startswith(b"!!"), _read)
