"""Evaluation of glare by evalglare, the reference of parity tests."""

import subprocess
from typing import NamedTuple

from radiance import ENVIRONMENT

# Our names of what `evalglare -d` prints in its last line
INDICES = {
    "av_lum": "average_luminance",
    "E_v": "illuminance",
    "lum_backg": "background_luminance",
    "E_v_dir": "direct_illuminance",
    "dgi": "dgi",
    "ugr": "ugr",
    "vcp": "vcp",
    "cgi": "cgi",
    "lum_sources": "source_luminance",
    "omega_sources": "source_solid_angle",
    "dgr": "dgr",
    "ugp": "ugp",
    "ugr_exp": "experimental_ugr",
    "dgi_mod": "modified_dgi",
    "ugp2": "logistic_ugp",
}


class Verdict(NamedTuple):
    """What evalglare says of a picture.

    Attributes
    ----------
    count : number of sources
    sources : rows of its table
    summary : its last line, by its own names
    lines : other lines of names and numbers
    """

    count: int
    sources: list[list[float]]
    summary: dict[str, float]
    lines: dict[str, float]


def evalglare(path, *options):
    done = subprocess.run(
        ["evalglare", "-d", *options, str(path)],
        env=ENVIRONMENT,
        capture_output=True,
        text=True,
        check=True,
    )
    count, sources, summary, lines = 0, [], {}, {}
    for line in done.stdout.splitlines():
        if line.startswith("dgp,"):
            names, values = line.split(": ")
            summary = dict(
                zip(names.split(","), map(float, values.split()), strict=True)
            )
        elif " No pixels " in line:
            count = int(line.split()[0])
        elif line[:1].isdigit():
            sources.append([float(word) for word in line.split()])
        elif ": " in line:
            names, values = line.split(": ")
            words = names.split(":")[-1].split(",")
            lines |= dict(zip(words, map(float, values.split()), strict=True))
    return Verdict(count, sources, summary, lines)
