"""`clerestory view`: the interactive page of a run, served or as a file."""

import shlex
from contextlib import suppress
from pathlib import Path

from clerestory.checks import one_of
from clerestory.cli.progress import say
from clerestory.cli.requests.study import View
from clerestory.report.explore_page import write_explorer
from clerestory.report.page import picture_folder
from clerestory.report.result_server import ResultServer, resources_of
from clerestory.report.vtkjs_results import write_vtkjs_results
from clerestory.study.results import read_results

# Extensions of files: a page, and a scene for viewers of VTK
_VTK = ".vtkjs"
_SUFFIXES = (".html", ".htm", _VTK)


def view(request: View) -> None:
    """Serve the interactive page of a run until interrupted, or write it to a file."""
    path = request.results
    results = read_results(path)
    folder = path if path.is_dir() else path.parent
    pictures = picture_folder(folder, results)
    if request.output is not None:
        one_of(request.output.suffix, "extension of the file", choices=_SUFFIXES)
        if request.output.suffix == _VTK:
            write_vtkjs_results(results, request.output)
        else:
            write_explorer(results, request.output, pictures=pictures)
        say(f"wrote {request.output}", quiet=request.quiet)
        return
    resources = resources_of(results, pictures=pictures)
    with ResultServer(resources, port=request.port) as server:
        say(f"open {server.address}", "to end, press Ctrl-C")
        with suppress(KeyboardInterrupt):
            server.serve_forever()


def view_command(results: Path) -> str:
    """Return the command that opens the interactive page of results."""
    return f"clerestory view {shlex.quote(str(results))}"
