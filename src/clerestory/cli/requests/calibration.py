"""Requests of `clerestory calibrate` and `optimise`."""

from pathlib import Path

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import argument, option


@command("calibrate:calibrate", "study.toml measured.toml -o calibrated")
class Calibrate:
    """Fit the unknown quantities of a study to measurements.

    The quantities and their distributions are those of [uncertainty] in the study file.
    Writes the fitted values, a study with them, and a page: agreement before and after,
    and on days that were not used.
    """

    study: Path = argument("Study file with a table [uncertainty].", "STUDY.toml")
    measured: Path = argument(
        "CSV file of times and sensors, or mapping file (.toml).", "MEASURED"
    )
    output: Path = option(Path("calibration"), "Folder for page and tables.", "-o")
    above: float = option(100.0, "Smallest measured value to include [lux].", least=0)
    shift: float = option(0.0, "Shift of the measured times [min].")
    coverage: float = option(
        0.75, "Smallest fraction of a time step with measurements.", least=0, most=1
    )
    quiet: common.Quiet = False


@command("optimise:optimise", "study.toml -o designs")
class Optimise:
    """Find designs of a study that are best for its goals, within its limits.

    Variables, goals and limits are those of [optimise] in the study file; [[variant]]
    or [sweep] are the discrete choices. The best designs are run in full and compared.
    """

    study: Path = argument("Study file with a table [optimise].", "STUDY.toml")
    output: Path = option(Path("designs"), "Folder for the runs and the page.", "-o")
    quiet: common.Quiet = False
