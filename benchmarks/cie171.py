"""The cases of CIE 171:2006 beside our engine: docs/validation/cie171.md.

    python benchmarks/cie171.py DATA [--write FILE]

DATA is the folder of reference data with standards/cie171.
"""

import argparse
import sys
from pathlib import Path

import numpy as np
from duel import stamp

sys.path.insert(0, str(Path(__file__).parents[1] / "tests" / "physics"))
from cie171_cases import CASES, Found

_HEAD = """# CIE 171:2006

Test cases of CIE 171:2006, *Test cases to assess the accuracy of lighting computer
programs*, whose references are analytical, set as scenes and traced by our engine
(`tests/physics/cie171_cases.py`). Made by `benchmarks/cie171.py`.

{stamp}

| case | quantity | values | deviation, median | largest | standard error | explained |
|---|---|---|---|---|---|---|
"""

_TAIL = """
*Deviation*: ours from the standard's, relative. *Our standard error*: the median,
relative to the standard's value. *Explained*: share of the values within four of our
standard errors, half of the standard's last digit, and 1 %.

- 5.2 to 5.8 are lit by lamps and reflecting surfaces, 5.9 and 5.11 by 16 skies (CIE S
  011 types 1 to 15 and the traditional overcast sky, sun 60° high). Illuminances are
  computed by daylight coefficients of 5185 patches, each with the mean of the sky's
  formula over it: the cases test the skies, their subdivision and the tracer together.
- 5.6: a small sun behind the sensors lights the floor. 5.7: the wall is a uniform
  emitter, as the standard's wall is uniformly lit; its table is NVIDIA's corrected one.
- 5.8: the mean over the cube's faces by Gauss's rule on 16 sensors each.
- Omitted, because no reference table was available: 5.1, 5.4 and 5.5 (the transcription
  of the latter is flagged as wrong), 5.10 and 5.12 (glazed openings), 5.13 and 5.14
  (outer obstructions), and the experimental cases of section 4.
"""


def row(found: Found) -> str:
    """Return a line of the table."""
    lit = found.truth > 0
    error = np.median(found.error[lit] / found.truth[lit])
    deviation = np.abs(found.relative)
    return (
        f"| {found.name} | {found.quantity} | {found.truth.size} |"
        f" {100 * np.median(deviation):.2f} % | {100 * deviation.max():.1f} % |"
        f" {100 * error:.2f} % | {100 * np.mean(found.explained):.1f} % |"
    )


def main() -> None:
    """Trace all cases and print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("data", type=Path)
    parser.add_argument("--write", type=Path)
    words = parser.parse_args()
    rows = [row(found) for case in CASES for found in case(words.data)]
    text = _HEAD.format(stamp=stamp()) + "\n".join(rows) + "\n" + _TAIL
    if words.write:
        words.write.write_text(text)
    else:
        print(text)


if __name__ == "__main__":
    main()
