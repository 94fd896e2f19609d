"""Request of `clerestory glare`."""

from pathlib import Path
from typing import Literal

from clerestory.cli.command import command
from clerestory.cli.requests.common import Quiet
from clerestory.glare.evalglare_options import Circle, EvalglareOptions
from clerestory.options import argument, option


@command("glare:glare", "desk.hdr --detail --check found.hdr")
class GlareRequest:
    """Find the glare sources of fisheye pictures and print DGP, DGI, UGR, VCP and CGI.

    Options have the names and the meaning of evalglare options, except that its -q is
    --background.
    """

    files: list[Path] = argument("Fisheye pictures, .hdr, .pic or .exr.", "PICTURE…")
    form: Literal["text", "json", "csv"] = option(
        "text", "text prints the lines of evalglare.", "--format"
    )
    detail: bool = option(False, "Print all indices and all glare sources.", "-d")
    options: EvalglareOptions
    error: list[Path] = option(
        (),
        "Standard errors of the pixels, from render --error; one file per picture.",
        metavar="F",
    )
    shown_task: Circle | None = option(
        None,
        "Like --task, and colour the task zone blue in the check picture.",
        "-T",
        "--",
        metavar="X Y ANGLE",
    )
    check: Path | None = option(
        None, "Check picture to write, with coloured glare sources.", "-c", metavar="F"
    )
    colour: tuple[float, float, float] | None = option(
        None, "Uniform colour of all glare sources.", "-u", metavar="R G B"
    )
    only_illuminance: bool = option(False, "Print only eye illuminance.", "-V", "--")
    annual: Path | None = option(
        None,
        "Evaluate pictures as time steps; write indices to .nc or .csv.",
        metavar="OUT",
    )
    quiet: Quiet = False
