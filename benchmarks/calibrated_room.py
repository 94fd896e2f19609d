"""A measured room, calibrated: docs/validation/measured-room-calibrated.md.

    python benchmarks/calibrated_room.py CHECKOUT [--write]

CHECKOUT is a copy of github.com/AltamarMx/radiance_nelier_simsv0p2.
"""

import argparse
import json
import shutil
import tempfile
from pathlib import Path

import numpy as np
from duel import stamp
from measured_room import ABOVE, STUDY, program

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "validation" / "measured-room-calibrated.md"

_TEXT = """# A measured room, calibrated

The [measured classroom](measured-room.md) is brighter in the simulation than in
reality. `clerestory calibrate` fits its glass, four reflectances and the clock to the
1192 measured illuminances of two days ([how](../uncertainty.md#calibration)): each
day is told by the fit to the other one. The study is
`studies/measured_classroom/calibration.toml`. Made by
`benchmarks/calibrated_room.py`.

{stamp}

| day not used | values | bias before | after | CV(RMSE) before | after |
|---|---|---|---|---|---|
{days}

| quantity | in the study | assumed | fitted to both days |
|---|---|---|---|
{quantities}

Notes:

- A measured value deviates by {error:.0f} % from the fitted model (root mean square
  of relative deviations). The deviations of one scan are alike:
  {effect:.0f} values count as one. Besides, all values of a sensor deviate alike by
  {sensor:.0f} %.
- The fit removes the bias on the day that was not used. Most of the scatter stays:
  clouds that pass within the hour of the weather file, people and trees that are not
  modelled, and windows that may extend too far are no quantities of this fit.
- The glass agrees with what the users found by hand: 0.70 to 0.80 instead of 0.88.
  The scans tell next to nothing of {untold}: these values are those that were
  assumed.
- Condition number of the data: {condition:.0f}; pairs that the data cannot tell
  apart: {alike}.
- The fit minimises relative deviations of all values alike, CV(RMSE) is about bright
  ones: with both days, bias {bias[0]:+.0f} to {bias[1]:+.0f} %, CV(RMSE)
  {scatter[0]:.0f} to {scatter[1]:.0f} %.
"""


def main() -> None:
    """Calibrate the room, and print or write the page."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("checkout", type=Path)
    parser.add_argument("--write", action="store_true")
    words = parser.parse_args()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        for file in STUDY.iterdir():
            shutil.copy(file, folder / file.name)
        shutil.copytree(words.checkout, folder / "nelier")
        files = ["calibration.toml", "measured.toml"]
        program(
            "calibrate", *files, "--above", f"{ABOVE:g}", "-o", "found", folder=folder
        )
        facts = json.loads((folder / "found" / "calibration.json").read_text())
    text = page(facts)
    if words.write:
        PAGE.write_text(text)
    else:
        print(text)


def page(facts: dict) -> str:
    """Return the page from the results of a calibration."""
    whole = facts["all_days"]
    alike = [f"{a} and {b} ({r:+.2f})" for a, b, r in facts["not_told_apart"]]
    return _TEXT.format(
        stamp=stamp(),
        days="\n".join(
            f"| {day} | {one['pairs']} | {_changes(one)} |"
            for day, one in facts["days_not_used"].items()
        ),
        quantities="\n".join(
            f"| {name} | {one['in_the_study']:.3g} |"
            f" {one['prior_mean']:.3g} ± {one['prior_deviation']:.2g} |"
            f" {one['value']:.3g} ± {one['deviation']:.2g} |"
            for name, one in facts["quantities"].items()
        ),
        error=100 * facts["relative_error"],
        effect=facts["design_effect"],
        sensor=100 * facts["sensor_error"],
        untold=" and ".join(facts["told_by_the_prior"]) or "nothing",
        condition=facts["condition"],
        alike=", ".join(alike) or "none",
        bias=[100 * value + 0.0 for value in np.round(whole["bias"], 2)],
        scatter=[100 * value for value in whole["cv_rmse"]],
    )


def _changes(one: dict) -> str:
    bias = [f"{100 * value:+.1f} %" for value in one["bias"]]
    scatter = [f"{100 * value:.0f} %" for value in one["cv_rmse"]]
    return " | ".join([*bias, *scatter])


if __name__ == "__main__":
    main()
