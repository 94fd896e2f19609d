"""Requests of the commands for studies: from a new study file to its metrics."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.common import (
    ClusterAddress,
    Device,
    Quiet,
    SceneFiles,
    WindowFiles,
)
from clerestory.options import Argument, option

DeviceChoice = Annotated[
    Device | None, option("Device in place of the study's.", "--device")
]
SeedChoice = Annotated[
    int | None, option("Seed in place of the study's.", "--seed", least=0)
]


@dataclass(frozen=True, kw_only=True)
class NewStudy:
    """Write a study file: the room, its window, a grid over the floor, the weather.

    The scene is the room without the glazing of the window, which the BSDF replaces.
    A window whose front does not face the room is reversed in a copy.
    """

    folder: Annotated[Path, Argument("Folder for the study; made if missing.", "DIR")]
    scene: SceneFiles
    window: WindowFiles
    bsdf: Annotated[Path, option("BSDF file (.xml).")]
    weather: Annotated[Path, option("Weather file (.epw, .wea, .csv).")]
    sensors: Annotated[
        Path | None, option("Sensor file in place of a grid over the floor.")
    ] = None
    spacing: Annotated[float, option("Spacing of the grid [m].", least=0.05)] = 0.5
    height: Annotated[
        float, option("Height of the grid above the floor [m].", least=0)
    ] = 0.76
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class RunStudy:
    """Run a study: trace, multiply by a year of sky, write results and a report.

    Matrices that are in OUT/matrices are not traced again; a run that was interrupted
    resumes.
    """

    study: Annotated[Path, Argument("The study.", "STUDY.toml")]
    out: Annotated[
        Path | None,
        option("Folder for the results; NAME_results beside NAME.toml if not given."),
    ] = None
    device: DeviceChoice = None
    seed: SeedChoice = None
    cluster: ClusterAddress = None
    plan: Annotated[
        bool, option("Print what will be traced and the cost, and stop.")
    ] = False
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class Demo:
    """Copy the bundled study, a test room behind a venetian blind, and run it.

    Files already in DIR are kept.
    """

    folder: Annotated[
        Path, Argument("Folder for the study and its results.", "DIR")
    ] = Path("clerestory_demo")
    device: DeviceChoice = None
    seed: SeedChoice = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class WriteReport:
    """Write the report of an earlier run again, from the files in its folder.

    Pictures are taken from the folder `pictures` beside results.nc.
    """

    results: Annotated[Path, Argument("Results folder or results.nc.", "RESULTS")]
    output: Annotated[Path | None, option("HTML file to write.", "-o")] = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class Metrics:
    """Print daylight autonomy, UDI, sDA, ASE, EN 17037 and LEED points per grid."""

    results: Annotated[
        Path,
        Argument(
            "Folder of a run (results.nc), or honeybee's results folder.", "RESULTS"
        ),
    ]
    grid: Annotated[list[str] | None, option("Only these grids.")] = None
    from_hour: Annotated[
        float, option("Start of the day [h].", "--from", least=0, most=24)
    ] = 8.0
    to_hour: Annotated[
        float, option("End of the day [h].", "--to", least=0, most=24)
    ] = 18.0
    target: Annotated[
        float, option("Target illuminance of daylight autonomy [lux].", least=1)
    ] = 300.0
    weather: Annotated[
        Path | None,
        option("Weather file for EN 17037, which counts half of the daylight hours."),
    ] = None
    states: Annotated[
        Path | None, option("CSV of shading states over the year (honeybee).")
    ] = None
    operate: Annotated[
        bool, option("Operate blinds by the rule of LM-83 (honeybee).", "--lm83")
    ] = False
    leed: Annotated[Literal["v4", "v4.1"], option("Version of LEED.")] = "v4.1"
    output: Annotated[Path | None, option("CSV with one line per sensor.", "-o")] = None
    honeybee: Annotated[
        Path | None, option("Write a results folder that honeybee loads.")
    ] = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class Compare:
    """Compare a study with measurements: shares within 5, 10 and 20 %, bias.

    A clock shift that would improve the agreement is reported, never applied.
    """

    measured: Annotated[
        Path,
        Argument(
            "CSV with a column of times and one per sensor; or a mapping (.toml) of"
            " files and columns to sensors.",
            "MEASURED",
        ),
    ]
    simulated: Annotated[
        list[Path] | None,
        Argument(
            "Folders of runs (results.nc), or CSV files; several side by side.",
            "SIMULATED…",
        ),
    ] = None
    output: Annotated[
        Path, option("Folder for the page, tables and figures.", "-o")
    ] = Path("comparison")
    name: Annotated[list[str] | None, option("Name of a simulation; one each.")] = None
    above: Annotated[float, option("Ignore measured values below [lux].", least=0)] = (
        100.0
    )
    shift: Annotated[float, option("Shift the measured times by [min].")] = 0.0
    coverage: Annotated[
        float,
        option("Least share of a time step with measurements.", least=0, most=1),
    ] = 0.75
    sensors: Annotated[
        Path | None,
        option("Write the sensors of a mapping's scans to this file, and stop."),
    ] = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class ImportModel:
    """Convert a honeybee model to a study, or an OBJ or glTF file to a scene.

    A honeybee model gives scene, windows, BSDFs, sensors, views and, with weather, a
    study. Objects that cannot be converted are listed.
    """

    model: Annotated[Path, Argument("A .hbjson, .obj, .gltf or .glb file.", "MODEL")]
    output: Annotated[Path, option("Folder for the files.", "-o")]
    weather: Annotated[
        Path | None, option("Weather file for the study of a honeybee model.")
    ] = None
    materials: Annotated[
        Path | None, option("Material map (.toml) of an OBJ or glTF file.")
    ] = None
    quiet: Quiet = False


@dataclass(frozen=True, kw_only=True)
class Doctor:
    """Check the compute devices and libraries; exit status 1 if one is broken."""


COMMANDS = {
    "new": Command(
        NewStudy,
        "study:new",
        "office --scene materials.rad room.rad --window glazing.rad --bsdf blind.xml"
        " --weather oslo.epw",
    ),
    "run": Command(RunStudy, "study:run", "study.toml --out results"),
    "demo": Command(Demo, "study:demo", "my_first_study"),
    "report": Command(WriteReport, "study:report", "study_results"),
    "metrics": Command(Metrics, "metrics:metrics", "results -o metrics.csv"),
    "compare": Command(
        Compare, "compare:compare", "measured.csv study_results -o found"
    ),
    "import": Command(
        ImportModel,
        "import_model:import_model",
        "room.hbjson --weather oslo.epw -o room",
    ),
    "doctor": Command(Doctor, "doctor:doctor"),
}
