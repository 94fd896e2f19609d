"""Requests of the commands for studies, reports, metrics and imports."""

from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import command
from clerestory.cli.requests import common
from clerestory.options import Option, argument, option, required

DeviceChoice = Annotated[
    common.Device | None, Option("Compute device; overrides the study.", "--device")
]
SeedChoice = Annotated[
    int | None,
    Option("Seed of the random numbers; overrides the study.", "--seed", least=0),
]


@command(
    "study:new",
    "office --scene materials.rad room.rad --window glazing.rad --bsdf blind.xml"
    " --weather oslo.epw",
)
class NewStudy:
    """Write a study file: rooms, their windows, a grid over each floor, the weather.

    The BSDF replaces the glazing of the windows: polygons in files of their own, or all
    polygons of materials that --glazing names. Of panes with several faces, the one
    towards the room is used. Panes whose front does not face the room are reversed in a
    copy; those of several rooms or orientations become several windows.
    """

    folder: Path = argument("Folder for the study; created if missing.", "DIR")
    scene: common.SceneFiles
    weather: Path = required("Weather file (.epw, .wea, .csv).")
    window: list[Path] | None = option(
        None, "Radiance files of windows that face the room.", metavar="F…"
    )
    glazing: list[str] | None = option(
        None,
        "Materials of the panes in the scene files, instead of --window.",
        metavar="NAME…",
    )
    bsdf: Path | None = option(
        None, "BSDF file (.xml), or library:NAME; default: low-e double glazing."
    )
    sensors: Path | None = option(None, "Sensor file instead of a grid over the floor.")
    spacing: float = option(0.5, "Spacing of the grid [m].", least=0.05)
    height: float = option(0.76, "Height of the grid above the floor [m].", least=0)
    units: Literal["metres", "centimetres", "millimetres", "feet", "inches"] = option(
        "metres",
        "Unit of length of the scene, the windows and the sensors: metres,"
        " centimetres, millimetres, feet or inches.",
        metavar="UNIT",
    )
    views: bool = option(False, "Propose views at the desks nearest to the windows.")
    quiet: common.Quiet = False


@command("study:run", "study.toml --out results")
class RunStudy:
    """Run a study: trace matrices, multiply by sky, write results and a report.

    Matrices in OUT/matrices are reused, so that an interrupted run can be resumed. A
    study with [[variant]] or [sweep] runs all variants and compares them.
    """

    study: Path = argument("Study file.", "STUDY.toml")
    out: Path | None = option(None, "Results folder; default: NAME_results.")
    device: DeviceChoice = None
    seed: SeedChoice = None
    cluster: common.ClusterAddress = None
    plan: bool = option(
        False, "Print the matrices to trace, the stages and their cost; do not run."
    )
    quiet: common.Quiet = False


@command("study:demo", "my_first_study")
class Demo:
    """Copy the bundled study, a test room behind a venetian blind, and run it.

    Files already in DIR are kept.
    """

    folder: Path = argument(
        "Folder for the study and its results.", "DIR", default=Path("clerestory-demo")
    )
    bsdf: Path | None = option(
        None, "BSDF file (.xml), or library:NAME, instead of the blind.", metavar="F"
    )
    device: DeviceChoice = None
    seed: SeedChoice = None
    quiet: common.Quiet = False


@command("study:report", "study_results --pdf")
class WriteReport:
    """Write the report of an earlier run from its results.

    Pictures are taken from the folder `pictures` beside results.nc. Title block and
    notes are those of the study, unless they are given here.
    """

    results: Path = argument("Results folder or results.nc.", "RESULTS")
    output: Path | None = option(None, "HTML file to write.", "-o")
    project: str | None = option(None, "Project in the title block.")
    client: str | None = option(None, "Client in the title block.")
    author: str | None = option(None, "Author in the title block.")
    logo: Path | None = option(None, "Logo in the title block (.png, .jpg).")
    notes: Path | None = option(None, "Notes in Markdown (.md).")
    pdf: bool = option(
        False, "Write a PDF file too; needs Chromium, Chrome or Edge.", "--pdf"
    )
    quiet: common.Quiet = False


@command("view:view", "study_results")
class View:
    """Show the results of a run in the browser: hours, limits, states, glare.

    The page is served on the loopback address, for reading alone, at an address with a
    random token. With -o it is written as one offline file of up to 12 MB instead, or,
    with the extension .vtkjs, room and metrics as a scene for viewers of VTK.
    """

    results: Path = argument("Results folder or results.nc.", "RESULTS")
    output: Path | None = option(
        None, "HTML or .vtkjs file to write, instead of serving.", "-o"
    )
    port: int = option(
        0, "Port of the address; default: a free one.", least=0, most=65535
    )
    quiet: common.Quiet = False


@command("metrics:metrics", "results -o metrics.csv")
class Metrics:
    """Print daylight autonomy, UDI, sDA, ASE, EN 17037 and LEED points per grid."""

    results: Path = argument("Results of a run, or honeybee results folder.", "RESULTS")
    grid: list[str] | None = option(None, "Grid to evaluate; repeatable. Default: all.")
    from_hour: float = option(8.0, "Start of the day [h].", "--from", least=0, most=24)
    to_hour: float = option(18.0, "End of the day [h].", "--to", least=0, most=24)
    target: float = option(300.0, "Target of daylight autonomy [lux].", least=1)
    weather: Path | None = option(None, "Weather file, needed for EN 17037.")
    states: Path | None = option(None, "CSV file of annual shading states (honeybee).")
    operate: bool = option(False, "Operate blinds by LM-83 (honeybee).", "--lm83")
    leed: Literal["v4", "v4.1"] = option("v4.1", "Version of LEED.")
    standard: list[str] | None = option(
        None, "Standard to assess; repeatable. Default: those of the study."
    )
    output: Path | None = option(None, "CSV file to write, one line per sensor.", "-o")
    honeybee: Path | None = option(None, "Results folder to write for honeybee.")
    quiet: common.Quiet = False


@command("compare:compare", "measured.csv study_results -o found")
class Compare:
    """Compare runs with measurements, or finished runs with each other.

    With measurements: bias, and fraction of values within 5, 10, 20 %; a time shift
    that would improve the agreement is reported but not applied. With results folders
    only: differences from the first run, with standard errors.
    """

    measured: Path = argument(
        "CSV file of times and sensors, mapping file (.toml), or results folder.",
        "MEASURED",
    )
    simulated: list[Path] | None = argument(
        "Folders of runs, or CSV files.", "SIMULATED…", default=None
    )
    output: Path = option(Path("comparison"), "Folder for page and tables.", "-o")
    name: list[str] | None = option(None, "Name of a simulation; repeatable.")
    above: float = option(100.0, "Smallest measured value to include [lux].", least=0)
    shift: float = option(0.0, "Shift of the measured times [min].")
    coverage: float = option(
        0.75, "Smallest fraction of a time step with measurements.", least=0, most=1
    )
    sensors: Path | None = option(None, "Write only the sensors of the mapping.")
    quiet: common.Quiet = False


@command(
    "import_model:import_model", "room.hbjson --weather oslo.epw -o room", name="import"
)
class ImportModel:
    """Convert a honeybee or IFC model to a study, an OBJ or glTF file to a scene.

    A model of a building is converted to scene, windows, BSDFs, sensors, views and,
    with --weather, a study. Rooms without sensors get a grid above their floor. Objects
    that cannot be converted are listed, also in left_out.txt; values that the model
    lacks in assumptions.txt.
    """

    model: Path = argument("Model file: .hbjson, .ifc, .obj, .gltf or .glb.", "MODEL")
    output: Path = required("Folder for the files.", "-o")
    weather: Path | None = option(None, "Weather file for the study (honeybee, IFC).")
    spacing: float = option(
        0.5, "Spacing of grids above floors [m] (honeybee, IFC).", least=0.05
    )
    height: float = option(
        0.76, "Height of grids above floors [m] (honeybee, IFC).", least=0
    )
    north: float | None = option(
        None,
        "Angle from +y to north, counter-clockwise [deg]; default: that of the model.",
        least=-360,
        most=360,
    )
    materials: Path | None = option(None, "Material map (.toml) for IFC, OBJ or glTF.")
    quiet: common.Quiet = False


@command("recipe:recipe", "annual-daylight inputs.json --folder project --workers 4")
class RunRecipe:
    """Run a recipe of Ladybug Tools: same inputs, same result folders.

    NAME is annual-daylight, annual-daylight-enhanced, annual-irradiance,
    cumulative-radiation, direct-sun-hours, daylight-factor, point-in-time-grid or
    sky-view.
    """

    name: str = argument("Name of the recipe.", "NAME")
    inputs: Path = argument("JSON file with the inputs of the recipe.", "INPUTS.json")
    folder: Path = option(
        Path(), "Project folder; results are in a folder NAME in it.", "-p"
    )
    workers: int | None = option(
        None, "Number of threads; default: all processors.", "-w", least=1
    )
    quiet: common.Quiet = False


@command("doctor:doctor")
class Doctor:
    """Check the compute devices and libraries; exit status 1 if one is broken."""
