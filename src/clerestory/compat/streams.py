"""Standard input and output of Radiance's programs: rays, matrices and pictures."""

import shutil
import sys
import tempfile
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

import numpy as np
from jaxtyping import Float

from clerestory.checks import one_of, require
from clerestory.errors import InputError
from clerestory.files import read_bytes
from clerestory.matrix.radiance_format import Encoding, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.progress import Progress

_ITEM = {"f": "f4", "d": "f8"}
ENCODINGS: dict[str, Encoding] = {"a": "ascii", "f": "float", "d": "double"}


@dataclass(frozen=True)
class Streams:
    """Standard input and output of a program.

    Attributes
    ----------
    source : file that is read as standard input
    sink : stream that is written as standard output
    command : command line, for the headers of files
    progress : callback with the fraction done and a note
    """

    source: Path = Path("/dev/stdin")
    sink: BinaryIO = field(default_factory=lambda: sys.stdout.buffer)
    command: str = "clerestory"
    progress: Progress | None = None

    def path(self, name: str) -> Path:
        """Return the path of an input; "-" is the standard input."""
        return self.source if name == "-" else Path(name)

    @contextmanager
    def output(self, name: str = "out") -> Iterator[Path]:
        """Yield a temporary file whose content is then written to standard output."""
        with tempfile.TemporaryDirectory() as folder:
            path = Path(folder, name)
            yield path
            with path.open("rb") as stream:
                shutil.copyfileobj(stream, self.sink)
            self.sink.flush()

    def write_matrix(
        self,
        matrix: TransferMatrix,
        *,
        encoding: Encoding,
        header: bool = True,
        variables: Mapping[str, str] | None = None,
    ) -> None:
        """Write a matrix, with further variables of its header, to standard output."""
        with self.output() as path:
            write_matrix(
                path,
                matrix,
                encoding=encoding,
                command=self.command,
                header=variables,
            )
            if not header:
                data = path.read_bytes()
                path.write_bytes(data[data.index(b"\n\n") + 2 :])


def read_rays(path: Path, form: str) -> Float[np.ndarray, "ray 6"]:
    """Read origins and directions of rays: "a" text, "f" float or "d" double."""
    one_of(form, "format of the rays", choices=("a", *_ITEM))
    data = read_bytes(path)
    if form != "a":
        item = np.dtype(_ITEM[form])
        require(
            len(data) % (6 * item.itemsize) == 0,
            f"{len(data)} bytes of rays; {6 * item.itemsize} for each ray expected",
            file=path,
        )
        values = np.frombuffer(data, item).astype(float)
    else:
        try:
            values = np.array(data.split(), dtype=float)
        except ValueError as error:
            raise InputError(
                f"no rays: {error}; x y z dx dy dz for each ray expected", file=path
            ) from error
    require(
        values.size and values.size % 6 == 0 and np.isfinite(values).all(),
        f"{values.size} numbers; six finite numbers (x y z dx dy dz) for each ray"
        " expected",
        file=path,
    )
    return values.reshape(-1, 6)
