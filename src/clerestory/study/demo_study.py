"""The study that comes with the package: a test room behind a venetian blind."""

import importlib.resources
from importlib.resources.abc import Traversable
from pathlib import Path

from clerestory.files import make_folder, replace_file

_WEATHER = "723170TYA.CSV"


def write_demo(folder: str | Path) -> Path:
    """Copy the demo study into a folder, made if need be; return its study file.

    Files that are there already stay as they are, with what the user changed in them.
    The weather is the TMY3 year of Greensboro, North Carolina, that pvlib carries.

    Raises
    ------
    OutputError : the folder cannot be made or written
    """
    folder = make_folder(folder)
    bundled = importlib.resources.files("clerestory") / "demo"
    weather = importlib.resources.files("pvlib") / "data" / _WEATHER
    for source in (*sorted(bundled.iterdir(), key=_name), weather):
        target = folder / source.name
        if source.is_file() and not target.exists():
            with replace_file(target) as stream:
                stream.write(source.read_bytes())
    return folder / "study.toml"


def _name(item: Traversable) -> str:
    return item.name
