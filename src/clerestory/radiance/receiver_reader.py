"""Reader of receiver files of rfluxmtx: windows, sky and ground.

A comment `#@rfluxmtx h=… u=… o=…` gives the sampling of the receiver after it: the
angular basis of a window (see `window_reader`), the Reinhart subdivision of the sky
(h=r1 … r6, or t), or one bin (h=u); and its output file.
"""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal

import numpy as np

from clerestory.array_types import Vector
from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.radiance.expansion import placed_items
from clerestory.radiance.statements import Directive, PolygonRun
from clerestory.radiance.window_reader import Pane, basis_of, up_of, window_of_panes
from clerestory.scene.primitive import Primitive
from clerestory.scene.surface import DistantSource
from clerestory.scene.window import Window, are_parallel


@dataclass(frozen=True)
class Hemisphere:
    """The sky or the ground as a receiver.

    `subdivision` is Reinhart's MF, or None for a single bin; `output` the file for the
    matrix, or None for the standard output.
    """

    name: str
    half: Literal["sky", "ground"]
    subdivision: int | None
    output: str | None = None


@dataclass(frozen=True, eq=False)
class WindowReceiver:
    """A window as a receiver; `output` is as in `Hemisphere`."""

    window: Window
    output: str | None = None

    @property
    def name(self) -> str:
        """Name of the window, its modifier."""
        return self.window.name


Receiver = Hemisphere | WindowReceiver


@dataclass(frozen=True)
class _Sampling:
    # Values of the variables of a comment #@rfluxmtx
    basis: str = ""
    up: str = ""
    output: str | None = None


def read_receivers(path: str | Path) -> tuple[Receiver, ...]:
    r"""Read the receivers of a file, one for each modifier, in order of appearance.

    Examples
    --------
    >>> import tempfile
    >>> text = "#@rfluxmtx h=r4 u=+Y\nvoid glow sky 0 0 4 1 1 1 0"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "sky.rad")
    ...     _ = file.write_text(text + " sky source dome 0 0 4 0 0 1 180")
    ...     [dome] = read_receivers(file)
    >>> dome.half, dome.subdivision
    ('sky', 4)
    """
    panes: dict[str, list[Pane]] = {}
    outputs: dict[str, str | None] = {}
    found: dict[str, Hemisphere | None] = {}
    for name, item, sampling in _sampled(path):
        outputs.setdefault(name, sampling.output)
        if isinstance(item, DistantSource):
            require(
                name not in found, f'receiver "{name}" has several sources', file=path
            )
            with located(file=path, subject=f'receiver "{name}"'):
                found[name] = _hemisphere(name, item, sampling)
            continue
        basis = basis_of(sampling.basis) if sampling.basis else "full"
        up = up_of(sampling.up) if sampling.up else None
        found.setdefault(name, None)
        panes.setdefault(name, []).extend(Pane(p, basis, up) for p in item.polygons())
    require(found, "no surfaces; the surfaces of a receiver expected", file=path)
    return tuple(
        half or WindowReceiver(_port(name, panes[name]), outputs[name])
        for name, half in found.items()
    )


def _port(name: str, panes: Sequence[Pane]) -> Window:
    # Window, or port whose polygons have several normals
    several = not are_parallel(tuple(pane.polygon for pane in panes))
    return window_of_panes(name, panes, faceted=several)


def _sampled(
    path: str | Path,
) -> Iterator[tuple[str, DistantSource | PolygonRun, _Sampling]]:
    # Surfaces by modifier, with the sampling of the last comment before them
    sampling = _Sampling()
    for placed in placed_items(path):
        match placed.item:
            case Directive():
                with located(file=placed.file, line=placed.item.line):
                    sampling = _read_sampling(placed.item.text, sampling)
            case PolygonRun():
                yield placed.item.modifier[0], placed.item, sampling
            case DistantSource():
                yield placed.item.material, placed.item, sampling
            case Primitive():
                pass  # materials
            case other:
                kind = type(other).__name__.lower()
                raise InputError(
                    f"the receiver has surfaces of type {kind}; polygons or a source"
                    " expected",
                    file=placed.file,
                )


def _read_sampling(text: str, before: _Sampling) -> _Sampling:
    given = {"h": before.basis, "u": before.up, "o": before.output}
    for word in text.split():
        key, _, value = word.partition("=")
        require(
            key in given and value,
            f'the variable of #@rfluxmtx is "{word}"; h=…, u=… or o=… expected',
        )
        given[key] = value.strip("\"'")
    return _Sampling(str(given["h"]), str(given["u"]), given["o"])


def _hemisphere(name: str, source: DistantSource, sampling: _Sampling) -> Hemisphere:
    vertical = abs(abs(source.direction[2]) - 1) < 1e-6
    require(
        vertical and abs(source.angle_deg - 180) < 1e-6,
        f"the source has direction {source.direction.tolist()} and angle"
        f" {source.angle_deg:g}°; the sky (0 0 1 180) or the ground (0 0 -1 180)"
        " expected",
    )
    text = sampling.basis.removeprefix("+").lower()
    half: Literal["sky", "ground"] = "sky" if source.direction[2] > 0 else "ground"
    if text in ("", "u", "s"):
        return Hemisphere(name, half, None, sampling.output)
    known = re.fullmatch(r"r([1-6]?)|t", text)
    require(
        known and half == "sky",
        f"h={sampling.basis} is not a basis of the {half}; "
        + ("u, t or r1 to r6 expected" if half == "sky" else "u expected"),
    )
    up = up_of(sampling.up) if sampling.up else np.array([0.0, 1.0, 0.0])
    _require_north(up, sampling.up)
    assert known is not None
    return Hemisphere(name, half, int(known[1] or 1), sampling.output)


def _require_north(up: Vector, text: str) -> None:
    require(
        up[1] > 0 and np.allclose(up[:1], 0),
        f"u={text} is not supported for the sky; u=+Y expected",
    )
