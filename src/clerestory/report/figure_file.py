"""Writer of Matplotlib figures as .png, .svg or .pdf."""

from pathlib import Path

from matplotlib.figure import Figure

from clerestory.checks import one_of
from clerestory.files import replace_file

_FORMATS = (".png", ".svg", ".pdf")


def figure_format(path: Path) -> str:
    """Return the format of a figure file by its extension."""
    suffix = path.suffix.lower()
    one_of(suffix, f"extension of {path.name}", choices=_FORMATS)
    return suffix[1:]


def write_figure(figure: Figure, path: str | Path) -> None:
    """Write a figure in the format given by the file extension."""
    kind = figure_format(Path(path))
    with replace_file(path) as stream:
        figure.savefig(stream, format=kind, dpi=150)
