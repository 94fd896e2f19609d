"""Request of `clerestory compat`."""

from pathlib import Path

from clerestory.cli.command import command
from clerestory.cli.requests.common import Quiet
from clerestory.options import required


@command("compat:compat", "rfluxmtx -I+ -ab 4 - window.rad -i room.oct < desks.pts")
class Compat:
    """Run a program of Radiance with its own options: compat PROGRAM …OPTIONS.

    The programs are rfluxmtx, rcontrib, dctimestep, rmtxop, gendaymtx, genskyvec and
    evalglare.
    With --install, write a folder of scripts with these names; if it is first in PATH,
    shell scripts that call the programs run on this package. Other programs, such as
    oconv and vwrays, remain those of Radiance.
    """

    install: Path = required("Folder for the scripts.", metavar="DIR")
    quiet: Quiet = False
