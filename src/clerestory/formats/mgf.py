"""Reader of MGF, the Materials and Geometry Format used in BSDF files.

Statements set the current vertex, colour and material, open and close transforms and
objects, and create surfaces. For a transform that is an array, the enclosed statements
are repeated for each instance.

All surfaces are two-sided, including those that MGF declares one-sided. Smooth shading
and included files are not supported.

References: G. Ward, "The Materials and Geometry Format", version 2, LBNL, 1996;
materials as converted by Radiance's mgf2rad.
"""

import math
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from functools import partial
from pathlib import Path

import numpy as np

from clerestory.checks import require
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.formats.mgf_definitions import (
    DEFINING,
    Definitions,
    MgfMaterial,
    MgfVertex,
    numbers,
)
from clerestory.formats.mgf_material import scene_material
from clerestory.formats.mgf_shape import Frustum, faces, joined_holes, prism, torus
from clerestory.formats.mgf_transform import TransformStack
from clerestory.scene.material import Source
from clerestory.scene.model import (
    Cone,
    Material,
    Polygon,
    Ring,
    Scene,
    Sphere,
    Surface,
    insert_material,
)
from clerestory.scene.surface import transformed
from clerestory.scene.transform import Transform

# Maximum number of statements, including repetitions by arrays
_MOST_STATEMENTS = 1_000_000

# Maximum number of open objects, whose names precede the names of surfaces
_MOST_OBJECTS = 100

# Number of statements that a torus counts as; words that count as a further statement
_PARTS, _WORDS = 20, 10


def parse_mgf(
    text: str,
    *,
    file: str | Path | None = None,
    line: int = 1,
    transform: Transform | None = None,
) -> Scene:
    """Return the scene of an MGF text.

    Parameters
    ----------
    file, line : file and line at which the text begins, for error messages
    transform : transform of the scene, applied after the transforms in the text

    Examples
    --------
    >>> slat = parse_mgf('''m white =
    ...     rd 0.7
    ... v a =
    ...     p 0 0 0
    ... v b =
    ...     p 1 0 0
    ... v c =
    ...     p 1 0.1 0
    ... xf -a 3 -t 0 0.2 0
    ... f a b c
    ... xf''')
    >>> len(slat.surfaces), slat.bounds()[1].round(3).tolist()
    (3, [1.0, 0.5, 0.0])
    """
    reading = _Reading(file, TransformStack(transform or Transform()))
    statements = list(_statements(text, line))
    _require_few(statements, file)
    at = 0
    while at < len(statements):
        number_of_line, words = statements[at]
        reading.line = number_of_line
        with located(file=file, line=number_of_line):
            back = reading.follow(words, at)
        at = at + 1 if back is None else back
    return Scene(reading.materials, tuple(reading.surfaces))


def _require_few(
    statements: list[tuple[int, list[str]]], file: str | Path | None
) -> None:
    # Count the statements with the repetitions by arrays; some make several surfaces
    total, open_ = 0.0, [1.0]
    for line, (keyword, *words) in statements:
        parts = _PARTS if keyword == "torus" else 1 + len(words) // _WORDS
        total += open_[-1] * (len(words) + 2 if keyword == "prism" else parts)
        if keyword == "xf" and words:
            after = (words[at + 1 : at + 2] for at, w in enumerate(words) if w == "-a")
            counts = (
                int(c[0]) for c in after if c and c[0].isdecimal() and len(c[0]) < 10
            )
            open_.append(open_[-1] * math.prod(counts, start=1.0))
        elif keyword == "xf" and len(open_) > 1:
            open_.pop()
        message = f"{min(total, 1e99):.2g} statements or more, repeated ones included"
        few = f"{message}; at most {_MOST_STATEMENTS:,} expected"
        require(total <= _MOST_STATEMENTS, few, file=file, line=line)


def _statements(text: str, line: int) -> Iterator[tuple[int, list[str]]]:
    # Statements with line numbers; a backslash at the end of a line continues it
    pending: list[str] = []
    start = line
    for number_of_line, row in enumerate([*text.split("\n"), ""], line):
        if not pending:
            start = number_of_line
        continued = row.rstrip("\r").endswith("\\")
        pending += row.rstrip("\r").removesuffix("\\").split()
        if not continued:
            if pending and not pending[0].startswith("#"):
                yield start, pending
            pending = []


@dataclass
class _Reading:
    # Current vertex, colour, material and transform; surfaces created so far
    file: str | Path | None
    place: TransformStack
    line: int = 1
    defined: Definitions = field(default_factory=Definitions)
    objects: list[str] = field(default_factory=list)
    materials: dict[str, Material] = field(default_factory=dict)
    keys: dict[tuple[str, MgfMaterial], str] = field(default_factory=dict)
    surfaces: list[Surface] = field(default_factory=list)
    unknown: set[str] = field(default_factory=set)

    def follow(self, words: list[str], at: int) -> int | None:
        """Execute an MGF statement; for a repeated array, return its start index."""
        keyword, *arguments = words
        if keyword == "xf":
            return self.place.follow(arguments, at)
        if keyword in DEFINING:
            DEFINING[keyword](self.defined, keyword, arguments)
        elif keyword in _MAKING:
            _MAKING[keyword](self, keyword, arguments)
        elif keyword in ("i", "ies"):
            raise InputError(f"{keyword} includes another file, which is not supported")
        elif keyword not in self.unknown:
            self.unknown.add(keyword)
            place = f"{self.file or 'MGF'}:{self.line}"
            message = f"{place}: unknown statement {keyword[:20]!r} is omitted"
            warnings.warn(message, ClerestoryWarning, stacklevel=4)
        return None

    def object(self, keyword: str, words: list[str]) -> None:
        """Open an object with a name, or close the innermost open object."""
        require(
            len(words) == 1 or (self.objects and not words),
            f"{len(words)} names after {keyword} with {len(self.objects)} objects open;"
            " one name, or none to close an object, expected",
        )
        message = f"more than {_MOST_OBJECTS} nested objects; fewer expected"
        require(len(self.objects) < _MOST_OBJECTS or not words, message)
        if words:
            self.objects.append(words[0])
        else:
            self.objects.pop()

    def face(self, keyword: str, words: list[str]) -> None:
        """Add a face, with holes for the keyword fh."""
        if keyword == "fh":
            words = joined_holes(words)
        require(len(words) > 2, f"{len(words)} vertices of a face; 3 or more expected")
        self.add_face([self.defined.vertices[name] for name in words])

    def prism(self, keyword: str, words: list[str]) -> None:
        """Add the faces of a prism."""
        count = len(words)
        require(
            count > 3,
            f"{count} words after {keyword}; a length and 3 or more vertices expected",
        )
        [length] = numbers(keyword, words[-1:], 1)
        base = [self.defined.vertices[name] for name in words[:-1]]
        for corner in prism(base, length):
            self.add_face(corner)

    def cone(self, keyword: str, words: list[str]) -> None:
        """Add a cylinder or a cone."""
        count, expected = len(words), 3 if keyword == "cyl" else 4
        require(
            count == expected, f"{count} words after {keyword}; {expected} expected"
        )
        radii = numbers(keyword, [words[1], words[-1 if keyword == "cone" else 1]], 2)
        base, top = (np.array(self.defined.vertices[words[k]].point) for k in (0, 2))
        self.add_frustum(Frustum(base, radii[0], top, radii[1]))

    def round(self, keyword: str, words: list[str]) -> None:
        """Add a sphere, a ring or a torus."""
        radii = numbers(keyword, words[1:], 1 if keyword == "sph" else 2)
        vertex = self.defined.vertices[words[0]]
        if keyword == "sph":
            require(radii[0] != 0, "a sphere of radius 0; a radius expected")
            centre, inward = np.array(vertex.point), radii[0] < 0
            self.add("s", partial(Sphere, centre, abs(radii[0]), inward))
        elif keyword == "ring":
            require(
                vertex.normal is not None and 0 <= radii[0] < radii[1],
                f"ring from {radii[0]:g} to {radii[1]:g}; increasing radii and a vertex"
                " with a normal expected",
            )
            centre, normal = np.array(vertex.point), np.array(vertex.normal)
            self.add("r", partial(Ring, centre, normal, radii[0], radii[1]))
        else:
            for part in torus(vertex, *radii):
                self.add_frustum(part)

    def add_face(self, corner: list[MgfVertex]) -> None:
        """Add the polygons of a face."""
        for piece in faces(corner):
            self.add("f", partial(Polygon, np.array([v.point for v in piece])))

    def add_frustum(self, part: Frustum) -> None:
        """Add the lateral surface of a truncated cone."""
        radii = part.base_radius, part.top_radius
        require(
            radii != (0, 0) and not min(radii) < 0 < max(radii),
            f"cone of radii {radii[0]:g} and {radii[1]:g}; equal signs, and a radius"
            " other than 0, expected",
        )
        flat = np.array_equal(part.base, part.top)
        require(not flat, "a cone without height; two different points expected")
        low, high = map(abs, radii)
        self.add("c", partial(Cone, part.base, part.top, low, high, min(radii) < 0))

    def add(
        self, letter: str, make: Callable[[str, str, Source | None], Surface]
    ) -> None:
        """Add a transformed surface with the current material."""
        made = make(self.key(), self.name(letter), self.source())
        self.surfaces.append(transformed(made, self.place.transform))

    def key(self) -> str:
        """Return the key under which the scene holds the current material."""
        named = self.defined.materials.name or "mat", self.defined.materials.current
        if named not in self.keys:
            new = scene_material(named[1], named[0], self.source())
            self.keys[named] = insert_material(self.materials, new)
        return self.keys[named]

    def name(self, letter: str) -> str:
        """Return the name of the next surface: open objects, a letter and a number."""
        path = [*self.objects, *self.place.instances]
        return ".".join([*path, f"{letter}{len(self.surfaces) + 1}"])

    def source(self) -> Source | None:
        """Return file and line of the statement; None if the text has no file."""
        return None if self.file is None else Source(str(self.file), self.line)


_MAKING: dict[str, Callable[[_Reading, str, list[str]], None]] = {
    **dict.fromkeys(("f", "fh"), _Reading.face),
    **dict.fromkeys(("cyl", "cone"), _Reading.cone),
    **dict.fromkeys(("sph", "ring", "torus"), _Reading.round),
    "o": _Reading.object,
    "prism": _Reading.prism,
}
