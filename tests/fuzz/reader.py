"""Readers of files from outside, each with small sound files of its format."""

import importlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

Use = Callable[[Callable[..., Any], Path], object]


@dataclass(frozen=True)
class Reader:
    """A function that reads a file from outside.

    Attributes
    ----------
    function : "module:name" below `clerestory`
    file : name of the file to read
    texts : sound files
    make : function of a folder that returns further sound files
    beside : other files in the folder, by name
    use : function of the reading function and the path; default: a plain call
    sealed : function that gives a damaged file a valid checksum
    cost : divisor of the number of damaged files, for readers that take long
    """

    function: str
    file: str
    texts: tuple[str, ...] = ()
    make: Callable[[Path], list[bytes]] | None = None
    beside: dict[str, str] = field(default_factory=dict)
    use: Use | None = None
    sealed: Callable[[bytes], bytes] | None = None
    cost: int = 1

    def seeds(self, folder: Path) -> list[bytes]:
        """Write the files beside, and return the sound files."""
        for name, text in self.beside.items():
            (folder / name).write_text(text)
        made = self.make(folder) if self.make else []
        (folder / self.file).parent.mkdir(parents=True, exist_ok=True)
        return [text.encode() for text in self.texts] + made

    def called(self) -> Callable[..., Any]:
        """Return the reading function."""
        module, name = self.function.split(":")
        found = getattr(importlib.import_module(f"clerestory.{module}"), name)
        return found if self.use is None else lambda path: self.use(found, path)
