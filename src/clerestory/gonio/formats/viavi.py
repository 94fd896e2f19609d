"""Text files of RPC Photonics' scatterometer: one incident direction per file.

Two lines that start with !! are followed by the incident angles and by lines of θ, φ
and BSDF [1/sr]. The incident φ is the azimuth of propagation: undeviated transmission
and mirror reflection are at the same φ. The file does not state whether values are for
reflection or for transmission.

Reference: files of the engineered diffuser EDS10 in ua-loft/bsdf-tools, and Photon
Engineering's article 304 on these files.
"""

from collections.abc import Iterator
from pathlib import Path

from clerestory.checks import require
from clerestory.gonio.formats.file_format import (
    FileFormat,
    ReadOptions,
    numbered_lines,
    scan_of_block,
)
from clerestory.gonio.scattering_measurement import Measurement


def _read(path: Path, options: ReadOptions) -> Iterator[Measurement]:
    lines = numbered_lines(path)
    body = [line for line in lines if not line[1].startswith("!!")]
    require(
        0 < len(body) < len(lines),
        "header lines (starting with !!) or data lines are missing; a file of RPC"
        " Photonics' scatterometer expected",
    )
    words = lines[0][1].lstrip("!").split()
    function = options.function or "transmission_front"
    scan = scan_of_block(body, path)
    yield Measurement((scan,), function, name=words[0] if words else "")


FORMAT = FileFormat("viavi", lambda head: head.data.startswith(b"!!"), _read)
