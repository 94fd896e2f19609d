"""dctimestep and rmtxop: products, sums and component weights of matrices.

References: G. Ward, manual pages of dctimestep(1) and rmtxop(1).
"""

import importlib
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import reduce
from itertools import pairwise
from operator import matmul
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB, unnamed_bands
from clerestory.checks import one_of, require
from clerestory.compat.streams import ENCODINGS, Streams
from clerestory.compat.words import NUMBERS, Grammar, reals, whole
from clerestory.errors import InputError, MatrixError
from clerestory.files import read_bytes
from clerestory.matrix.axis import unknown_axis
from clerestory.matrix.radiance_format import (
    Encoding,
    parse_matrix,
)
from clerestory.matrix.transfer_matrix import TransferMatrix

_TIMESTEP = Grammar(
    "dctimestep", {"-n": 1, "-h": 0, "-o": 1, "-x": 1, "-y": 1}, ("-i", "-o")
)
_OPERATION = Grammar(
    "rmtxop",
    {"-v": 0, "-t": 0, "-s": NUMBERS, "-c": NUMBERS, "-n": 1},
    ("-f",),
)
_ITEM = {"a": "f8", "f": "f4", "d": "f8"}


def dctimestep(words: Sequence[str], streams: Streams) -> None:
    """Run dctimestep: C S, or V T D S, for all time steps of S."""
    call = _parse_timestep(words)
    others = [_read(name, streams)[0] for name in call.factors[1:]]
    others.append(_sky(call, others, streams))
    name, like = call.factors[0], None
    if "%" in name:
        # As many pictures as there are rows: others may follow, as in the tutorial
        read = _module("compat.picture_products").read_picture_set
        first, like = read(Path(name), most=others[0].rows.size)
    else:
        first, _ = _read(name, streams)
    product = reduce(matmul, _fitting([first, *others]))
    if like is not None:
        write = _module("compat.picture_products").write_pictures
        write(product, like, call.output, streams)
    elif call.output is None:
        encoding = ENCODINGS[call.writing]
        streams.write_matrix(product, encoding=encoding, header=call.header)
    else:
        raise InputError(
            f"dctimestep: option is -o {call.output} without a set of pictures; no -o"
            " expected"
        )


@dataclass(frozen=True)
class _Timestep:
    # Options and matrices of dctimestep; the sky is a name, or "-"
    factors: tuple[str, ...]
    sky: str
    output: str | None = None
    header: bool = True
    steps: int | None = None
    reading: str = "a"
    writing: str = "a"


def _parse_timestep(words: Sequence[str]) -> _Timestep:
    options: dict[str, str | int | bool | None] = {}
    operands = []
    for word in _TIMESTEP.words(words):
        match word.name:
            case "":
                operands.append(word.text)
            case "-h":
                options["header"] = word.on if word.sign else False
            case "-n":
                options["steps"] = whole(word, "dctimestep", least=1)
            case "-i":
                one_of(word.text, "dctimestep -i", choices=("a", "f", "d", "h"))
                options["reading"] = word.text
            case "-o" if word.joined:
                one_of(word.text, "dctimestep -o", choices=tuple("afdc"))
                options["writing"] = "f" if word.text == "c" else word.text
            case "-o":
                options["output"] = word.text
    require(
        1 <= len(operands) <= 4,
        f"dctimestep: {len(operands)} matrices given; DC [SKY] or V T D [SKY] expected",
    )
    count = 3 if len(operands) >= 3 else 1
    sky = operands[count] if len(operands) > count else "-"
    return _Timestep(tuple(operands[:count]), sky, **options)  # type: ignore[arg-type]


def _sky(
    call: _Timestep, others: list[TransferMatrix], streams: Streams
) -> TransferMatrix:
    path = streams.path(call.sky)
    data = read_bytes(path)
    if data.startswith(b"#?"):
        return parse_matrix(data, path)[0]
    # Without header, as written by genskyvec: patches by time steps by components
    rows = others[-1].columns.size if others else 0
    columns, channels = call.steps or 1, len(RGB)
    require(
        call.reading in _ITEM,
        f"dctimestep: the sky has no header with -i{call.reading}; one expected",
        file=path,
    )
    try:
        item = _ITEM[call.reading]
        text = call.reading == "a"
        values = np.array(data.split() if text else np.frombuffer(data, item), float)
    except ValueError as error:
        raise InputError(
            f"no sky vector: {error}; numbers expected", file=path
        ) from error
    expected = f"{rows or 'whole'} patches of {columns} time steps and {channels}"
    require(
        values.size and values.size % ((rows or 1) * columns * channels) == 0,
        f"{values.size} values; {expected} components expected",
        file=path,
    )
    table = values.reshape(-1, columns, channels)
    return _unlabelled(np.moveaxis(table, -1, 0).copy())


def rmtxop(words: Sequence[str], streams: Streams) -> None:
    """Run rmtxop: operations on matrices, from left to right."""
    form, terms = _parse_operation(words)
    total, encoding = terms[0].matrix(streams)
    for term in terms[1:]:
        other, own = term.matrix(streams)
        total = _combined(total, other, term.operator)
        encoding = min(encoding, own, key=list(ENCODINGS.values()).index)
    encoding = ENCODINGS[form] if form else encoding
    streams.write_matrix(total, encoding=encoding)


@dataclass(frozen=True)
class _Term:
    # A matrix, the operator before it and the options that change it
    operator: str
    name: str
    transposed: bool = False
    scale: tuple[float, ...] = ()
    weights: tuple[float, ...] = ()

    def matrix(self, streams: Streams) -> tuple[TransferMatrix, Encoding]:
        """Return the changed matrix, and the encoding of its file."""
        matrix, encoding = _read(self.name, streams)
        values = matrix.values
        channels = len(values)
        if self.scale:
            require(
                len(self.scale) in (1, channels),
                f"rmtxop: -s has {len(self.scale)} numbers; 1 or {channels} expected",
            )
            values = values * np.array(self.scale)[:, None, None]
        if self.weights:
            require(
                len(self.weights) % channels == 0,
                f"rmtxop: -c has {len(self.weights)} numbers; {channels} for each"
                " component of the result expected",
            )
            each = np.array(self.weights).reshape(-1, channels)
            values = np.tensordot(each, values, axes=1)
        if self.transposed:
            values = np.swapaxes(values, 1, 2)
        return _unlabelled(values), encoding


def _parse_operation(words: Sequence[str]) -> tuple[str, list[_Term]]:
    form, terms, pending, operator = "", [], _Term(".", ""), ""
    for word in _OPERATION.words(words):
        match word.name:
            case "" if word.text in (".", "+", "*", "/"):
                operator = word.text
            case "":
                terms.append(replace(pending, operator=operator or ".", name=word.text))
                pending, operator = _Term(".", ""), ""
            case "-f":
                one_of(word.text, "rmtxop -f", choices=tuple(ENCODINGS))
                form = word.text
            case "-t":
                pending = replace(pending, transposed=True)
            case "-s":
                pending = replace(pending, scale=reals(word, "rmtxop"))
            case "-c":
                require(
                    word.arguments,
                    "rmtxop: -c has no numbers; one for each component expected",
                )
                pending = replace(pending, weights=reals(word, "rmtxop"))
    require(terms, "rmtxop: no matrix given; one or more expected")
    return form, terms


def _combined(
    one: TransferMatrix, other: TransferMatrix, operator: str
) -> TransferMatrix:
    if operator == ".":
        return reduce(matmul, _fitting([one, other]))
    same = one.values.shape[1:] == other.values.shape[1:]
    require(
        same,
        f"rmtxop: matrices of {one.values.shape[1:]} and {other.values.shape[1:]} rows"
        f" and columns with {operator}; equal sizes expected",
        error=MatrixError,
    )
    with np.errstate(divide="ignore", invalid="ignore"):
        match operator:
            case "+":
                values = one.values + other.values
            case "*":
                values = one.values * other.values
            case _:
                values = np.nan_to_num(one.values / other.values, posinf=0, neginf=0)
    return _unlabelled(values)


def _read(name: str, streams: Streams) -> tuple[TransferMatrix, Encoding]:
    # Matrix of a file and its encoding; of a BSDF, its transmission
    path = streams.path(name)
    if path.suffix.lower() != ".xml":
        return parse_matrix(read_bytes(path), path)
    bsdf = _module("library.bsdf_source").read_bsdf(path)
    return bsdf.transmission_matrix(), "ascii"


def _module(name: str) -> Any:
    # Module for pictures or BSDFs, which most calls do not have: imported when needed
    return importlib.import_module(f"clerestory.{name}")


def _fitting(matrices: list[TransferMatrix]) -> list[TransferMatrix]:
    # Matrices as factors of a product, without labels
    for left, right in pairwise(matrices):
        require(
            left.columns.size == right.rows.size,
            f"a matrix of {left.columns.size} columns before one of"
            f" {right.rows.size} rows; equal numbers expected",
            error=MatrixError,
        )
    return [_unlabelled(matrix.values) for matrix in matrices]


def _unlabelled(values: Float[np.ndarray, "channel row column"]) -> TransferMatrix:
    rows, columns = (unknown_axis(size) for size in values.shape[1:])
    bands = unnamed_bands(len(values))
    return TransferMatrix(values, rows, columns, bands=bands)
