"""Rays from standard input and output of coefficients, for rfluxmtx and rcontrib.

Rays are sensors with -I (irradiance), otherwise bundles of rays that receive radiance;
with -i, the surfaces that the rays meet are sensors.
"""

from collections import Counter
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.checks import require
from clerestory.compat.streams import ENCODINGS, Streams, read_rays
from clerestory.compat.words import Word, reals, whole
from clerestory.errors import InputError
from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.image.picture_sets import numbered
from clerestory.matrix.axis import unknown_axis
from clerestory.matrix.radiance_format import write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.scene.ray_bundles import RayBundles
from clerestory.scene.sensors import Sensors

# Options with numbers of arguments; `IGNORED` has the others
RAY_OPTIONS = {
    **dict.fromkeys(("-ab", "-ad", "-c", "-dj", "-x", "-y", "-o"), 1),
    **dict.fromkeys(("-I", "-i", "-h"), 0),
}

Table = Float[np.ndarray, "channel row column"]


@dataclass(frozen=True)
class RayOptions:
    """Options of rfluxmtx and rcontrib.

    Attributes
    ----------
    bounces : -ab
    directions : -ad, rays into the hemisphere at a surface
    count : -c, rays of each record, or samples of each bin of a sender
    centred : with -dj 0, a sensor sees the sun if it sees the centre of its disc
    columns, rows : -x and -y, the resolution of pictures
    reading, writing : formats of input (a, f, d) and output (a, f, d, c)
    output : -o, name of output files; None for standard output
    quantity : "sensor" with -I, "surface" with -i, otherwise "radiance"
    header : whether output has a header (-h)
    """

    program: str
    bounces: int = 1
    directions: int = 350
    count: int = 1
    centred: bool = False
    columns: int = 0
    rows: int = 0
    reading: str = "a"
    writing: str = "a"
    output: str | None = None
    quantity: str = "radiance"
    header: bool = True

    def changed(self, word: Word) -> "RayOptions":
        """Return the options changed by an option of the command line."""
        name, program = word.name, self.program
        match name:
            case "-ab":
                return replace(self, bounces=whole(word, program))
            case "-ad":
                return replace(self, directions=whole(word, program, least=1))
            case "-c":
                return replace(self, count=whole(word, program, least=1))
            case "-dj":
                return replace(self, centred=reals(word, program)[0] == 0)
            case "-x":
                return replace(self, columns=whole(word, program))
            case "-y":
                return replace(self, rows=whole(word, program))
            case "-V":
                require(
                    word.sign and not word.on,
                    f"{program}: option is -V+ (contributions), which is not supported;"
                    " -V- (coefficients) expected",
                )
                return self
            case "-o":
                return replace(self, output=word.text)
            case "-h":
                return replace(self, header=word.on if word.sign else False)
            case "-I" | "-i":
                given = {"-I": "sensor", "-i": "surface"}[name]
                return replace(self, quantity=given if word.on else "radiance")
            case "-f":
                # -fo only allows rcontrib to replace files
                own = word.text.startswith("o")
                return self if own else self._formatted(word.text)
        return self

    def _formatted(self, text: str) -> "RayOptions":
        # -fio: formats of input and output; one letter for both
        both = text if len(text) > 1 else 2 * text
        require(
            len(both) == 2 and both[0] in "afd" and both[1] in "afdc",
            f"{self.program}: option is -f{text}; a letter of afd and one of afdc"
            " expected",
        )
        return replace(self, reading=both[0], writing=both[1])

    @property
    def seed(self) -> int:
        """Seed of random numbers: other numbers of rays have independent errors."""
        return (65537 * self.directions + self.count) % (1 << 32)

    def sensors(self, streams: Streams) -> Sensors:
        """Return the rays of standard input as irradiance sensors."""
        table = read_rays(streams.source, self.reading)
        require(
            self.count == 1,
            f"{self.program}: -c is {self.count} with -I; 1 expected",
        )
        return Sensors(table[:, :3], table[:, 3:])

    def bundles(self, streams: Streams) -> RayBundles:
        """Return the rays of standard input in bundles of `count`."""
        table = read_rays(streams.source, self.reading)
        require(
            len(table) % self.count == 0,
            f"{self.program}: {len(table)} rays with -c {self.count}; a multiple of"
            f" {self.count} expected",
        )
        rays = table.reshape(-1, self.count, 6)
        return RayBundles(rays[..., :3], rays[..., 3:])


def write_columns(
    parts: Iterable[tuple[str | None, Table]], given: RayOptions, streams: Streams
) -> None:
    """Write coefficients, side by side for each output: matrices, or a set of pictures.

    A part is the name of its output, or None for that of the options, and its columns.
    Pictures are written part by part.
    """
    tables: dict[str | None, list[Table]] = {}
    pictures: Counter[str | None] = Counter()
    for own, table in parts:
        name = given.output if own is None else own
        values = np.broadcast_to(table, (3, *table.shape[1:])).astype(np.float32)
        if given.writing == "c" or (name or "").endswith((".hdr", ".pic")):
            _write_pictures(name, values, pictures[name], given, streams)
            pictures[name] += values.shape[2]
        else:
            tables.setdefault(name, []).append(values)
    for name, found in tables.items():
        values = np.concatenate(found, axis=2)
        axes = unknown_axis(values.shape[1]), unknown_axis(values.shape[2])
        matrix, encoding = TransferMatrix(values, *axes), ENCODINGS[given.writing]
        if name is None:
            streams.write_matrix(matrix, encoding=encoding, header=given.header)
        else:
            write_matrix(name, matrix, encoding=encoding, command=streams.command)


def _write_pictures(
    name: str | None,
    values: Table,
    first: int,
    given: RayOptions,
    streams: Streams,
) -> None:
    _, pixels, columns = values.shape
    size = given.rows or 1, given.columns or pixels
    if size[0] * size[1] != pixels:
        raise InputError(
            f"{given.program}: {pixels} pixels with -x {given.columns} -y"
            f" {given.rows}; as many as columns times rows expected"
        )
    if name is None:
        require(
            first + columns == 1,
            f"{given.program}: several pictures without -o; -o with a number such as"
            " %03d expected",
        )
    for column in range(columns):
        pixel = np.moveaxis(values[..., column], 0, -1).reshape(*size, 3)
        picture = Picture(np.ascontiguousarray(pixel), header=(streams.command,))
        if name is None:
            with streams.output("out.hdr") as path:
                write_picture(picture, path)
        else:
            path = Path(name)
            many = "%" in path.name
            write_picture(picture, numbered(path, first + column) if many else path)
