"""Demo study: a test room with a venetian blind."""

import importlib.resources
from importlib.resources.abc import Traversable
from pathlib import Path

from clerestory.files import make_folder, replace_file

_WEATHER = "723170TYA.CSV"


def write_demo(folder: str | Path) -> Path:
    """Copy the demo study into a folder, created if missing; return its study file.

    Existing files are not overwritten. The weather is the TMY3 year of Greensboro,
    North Carolina, from pvlib.

    Raises
    ------
    OutputError : the folder cannot be created or written
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
