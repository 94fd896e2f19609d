"""Files of a calibration: values, pairs, and the calibrated study."""

import json
import os
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.comparison.calibration_run import CalibratedStudy
from clerestory.escaping import csv_line, toml_value
from clerestory.files import read_text, write_text
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.material_parameters import with_parameters
from clerestory.study.config import Study

VALUES_FILE, PAIRS_FILE = "calibration.json", "calibration_pairs.csv"
SCENE_FILE = "calibrated_scene.rad"

_VARIANT = """
# Added by `clerestory calibrate`: the same study with the fitted materials
[[variant]]
name = "calibrated"
scene.files = {files}
"""


def write_calibration(found: CalibratedStudy, folder: Path) -> None:
    """Write fitted values as JSON, and measured and simulated values as CSV."""
    write_text(folder / VALUES_FILE, json.dumps(facts(found), indent=2) + "\n")
    pairs, lines = found.model.pairs, ["time,series,measured,before,after"]
    for number, time in enumerate(pairs.times.astype("datetime64[m]").astype(str)):
        values = pairs.measured[number], found.before[number], found.after[number]
        name = pairs.names[pairs.series[number]]
        lines.append(csv_line([time, name, *(f"{v:.6g}" for v in values)]).rstrip())
    write_text(folder / PAIRS_FILE, "\n".join(lines) + "\n")


def facts(found: CalibratedStudy) -> dict[str, Any]:
    """Return the result of a calibration as plain values for JSON."""
    fit = found.calibration
    quantities = {}
    for number, unknown in enumerate(fit.unknowns):
        own = unknown.distribution
        quantities[unknown.name] = {
            "in_the_study": found.quantities.reference[unknown.name],
            "prior_mean": own.mean,
            "prior_deviation": own.standard_deviation,
            "value": float(fit.values[number]),
            "deviation": float(fit.deviations[number]),
        }
    before, after = found.agreements()
    return {
        "quantities": quantities,
        "correlations": np.round(fit.correlations, 4).tolist(),
        "relative_error": fit.relative_error,
        "sensor_error": fit.sensor_error,
        "design_effect": fit.design_effect,
        "condition": fit.condition if np.isfinite(fit.condition) else None,
        "told_by_the_prior": fit.untold(),
        "not_told_apart": [list(pair) for pair in fit.alike()],
        "at_an_end_of_the_range": fit.at_bounds(),
        "expansions": found.rounds,
        "all_days": {
            "pairs": before.count,
            "bias": [before.relative_bias, after.relative_bias],
            "cv_rmse": [before.variation, after.variation],
        },
        "days_not_used": {
            str(one.day): {
                "pairs": one.count,
                "bias": [one.before.relative_bias, one.after.relative_bias],
                "cv_rmse": [one.before.variation, one.after.variation],
                "within_95_percent": one.within,
            }
            for one in found.held_out
        },
    }


def write_calibrated_study(
    found: CalibratedStudy, study: Study, file: Path, folder: Path
) -> Path | None:
    """Write the study with a variant "calibrated"; return its path.

    The variant has the fitted materials in a scene file in `folder`. None without
    materials among the quantities.

    Raises
    ------
    InputError : the scene has patterns or textures, which cannot be written
    """
    values = found.quantities.of_materials(found.values)
    if not values:
        return None
    scene = with_parameters(read_rad(*study.scene.files), values)
    write_text(folder / SCENE_FILE, format_rad(scene, bsdf_file={}) + "\n")
    named = Path(os.path.relpath(folder.resolve() / SCENE_FILE, file.resolve().parent))
    made = file.with_name(f"{file.stem}_calibrated.toml")
    added = _VARIANT.format(files=toml_value([named.as_posix()]))
    write_text(made, read_text(file).rstrip("\n") + "\n" + added)
    return made
