"""Request of `clerestory glare`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Literal

from clerestory.cli.command import Command
from clerestory.cli.requests.common import Quiet
from clerestory.glare.evalglare_options import Circle, EvalglareOptions
from clerestory.options import Argument, option


@dataclass(frozen=True, kw_only=True)
class GlareRequest:
    """Find the glare sources of fisheye pictures and print DGP, DGI, UGR, VCP and CGI.

    Options have the letters and the meaning of evalglare's; only its -q is
    --background here.
    """

    files: Annotated[
        list[Path], Argument("Fisheye pictures, .hdr, .pic or .exr.", "PICTURE…")
    ]
    form: Annotated[
        Literal["text", "json", "csv"],
        option("text prints the lines of evalglare.", "--format"),
    ] = "text"
    detail: Annotated[
        bool, option("Print all indices, and the table of sources.", "-d")
    ] = False
    options: EvalglareOptions
    shown_task: Annotated[
        Circle | None,
        option(
            "As --task; blue in the check picture.", "-T", "--", metavar="X Y ANGLE"
        ),
    ] = None
    check: Annotated[
        Path | None,
        option("Picture with coloured sources to write.", "-c", metavar="F"),
    ] = None
    colour: Annotated[
        tuple[float, float, float] | None,
        option("One colour for all sources.", "-u", metavar="R G B"),
    ] = None
    only_illuminance: Annotated[
        bool, option("Print only the vertical eye illuminance.", "-V", "--")
    ] = False
    annual: Annotated[
        Path | None,
        option(
            "Evaluate the pictures as time steps of one view; write the indices to"
            " .nc or .csv.",
            metavar="OUT",
        ),
    ] = None
    quiet: Quiet = False


COMMANDS = {
    "glare": Command(GlareRequest, "glare:glare", "desk.hdr --detail --check found.hdr")
}
