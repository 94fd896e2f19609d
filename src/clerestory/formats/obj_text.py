"""Parser of Wavefront OBJ files: vertices and triangles by group and material.

Consecutive lines of vertices or of faces are converted together, other lines one by
one. Texture coordinates, normals, lines and points are ignored.

Reference: Wavefront Technologies, Object Files (.obj), Advanced Visualizer manual,
appendix B1.
"""

import warnings
from collections.abc import Iterator
from dataclasses import dataclass, field

import numpy as np
from jaxtyping import Bool, Float, Int, UInt8

from clerestory.checks import require
from clerestory.errors import InputError, located
from clerestory.scene.transform import LARGEST
from clerestory.scene.triangulate import simple_faces

# Approximate maximum size of a run of lines that is converted together [bytes]
_PIECE = 1 << 23

_SPACES = np.zeros(256, dtype=bool)
_SPACES[list(b" \t\r\n\v\f")] = True

_OTHER, _VERTEX, _FACE, _PASSED = range(4)

# Maximum number of corners of a face
_MOST_CORNERS = 100_000


@dataclass(frozen=True, eq=False)
class ObjPart:
    """Triangles of one group and one material, as vertex indices from 0.

    `group` and `material` are empty if not given; `line` is the first face's line.
    """

    group: str
    material: str
    faces: Int[np.ndarray, "triangles 3"]
    line: int


@dataclass(frozen=True, eq=False)
class ObjText:
    """Text of an OBJ file: vertices (file units), triangles by group and material, and
    file paths of material libraries.
    """

    vertices: Float[np.ndarray, "vertices 3"]
    parts: tuple[ObjPart, ...]
    libraries: tuple[str, ...]


def parse_obj(data: bytes, *, file: str) -> ObjText:
    r"""Return the vertices and triangles of an OBJ file."""
    if b"\\" in data:
        data = data.replace(b"\\\r\n", b"   ").replace(b"\\\n", b"  ")
    reading = _Reading(file)
    letters = np.frombuffer(data + b"\n", dtype=np.uint8)
    for kind, first, last, line in _runs(letters):
        match kind:
            case 1:
                reading.add_vertices(letters[first:last], line)
            case 2:
                reading.add_faces(letters[first:last], line)
            case 0:
                reading.add_lines(letters[first:last].tobytes(), line)
    return reading.result()


def _runs(letters: UInt8[np.ndarray, " bytes"]) -> Iterator[tuple[int, int, int, int]]:
    # Runs of lines of the same kind: kind, first byte, end byte and first line
    ends = np.flatnonzero(letters == ord("\n"))
    starts = np.append(0, ends[:-1] + 1)
    one = letters[starts]
    two = letters[np.minimum(starts + 1, len(letters) - 1)]
    spaced = _SPACES[two]
    kind = np.full(len(starts), _OTHER)
    kind[(one == ord("v")) & spaced] = _VERTEX
    kind[(one == ord("f")) & spaced] = _FACE
    passed = ((one == ord("v")) & ~spaced) | (one == ord("#")) | (one == ord("\n"))
    kind[passed | (one == ord("\r"))] = _PASSED
    # Runs end where the kind of line changes; long runs are divided into pieces
    piece = starts // _PIECE
    change = np.flatnonzero((np.diff(kind) != 0) | (np.diff(piece) != 0)) + 1
    for begin, end in zip([0, *change], [*change, len(starts)], strict=True):
        if kind[begin] != _PASSED:
            yield int(kind[begin]), starts[begin], ends[end - 1] + 1, begin + 1


@dataclass
class _Reading:
    file: str
    group: str = ""
    material: str = ""
    libraries: list[str] = field(default_factory=list)
    vertices: list[np.ndarray] = field(default_factory=list)
    parts: dict[tuple[str, str], list[np.ndarray]] = field(default_factory=dict)
    lines: dict[tuple[str, str], int] = field(default_factory=dict)
    count: int = 0

    def add_vertices(self, letters: UInt8[np.ndarray, " bytes"], line: int) -> None:
        values, words = self._numbers(letters, line)
        short = int(np.argmin(words >= 3))
        message = f"a vertex of {words[short]} numbers; 3 expected"
        require(words[short] >= 3, message, file=self.file, line=line + short)
        first = np.cumsum(words) - words
        points = values[first[:, None] + np.arange(3)]
        known = np.isfinite(points).all(axis=1)
        bad = line + int(np.argmin(known))
        require(known.all(), "a coordinate is not finite", file=self.file, line=bad)
        near = (np.abs(points) <= LARGEST).all(axis=1)
        message = f"a coordinate exceeds {LARGEST:.0e} m"
        bad = line + int(np.argmin(near))
        require(near.all(), message, file=self.file, line=bad)
        self.vertices.append(points)
        self.count += len(points)

    def add_faces(self, letters: UInt8[np.ndarray, " bytes"], line: int) -> None:
        values, words = self._numbers(_without_slashes(letters), line)
        valid = (words >= 3) & (words <= _MOST_CORNERS)
        bad = int(np.argmin(valid))
        message = f"a face of {words[bad]} vertices; 3 to {_MOST_CORNERS} expected"
        require(valid[bad], message, file=self.file, line=line + bad)
        corner = np.where(values < 0, values + self.count, values - 1)
        wrong = (corner < 0) | (corner >= self.count) | (corner != np.trunc(corner))
        at = int(np.argmax(wrong))
        face = int(np.searchsorted(np.cumsum(words), at, side="right"))
        message = f"a face refers to vertex {values[at]:g}, but {self.count} precede it"
        require(not wrong[at], message, file=self.file, line=line + face)
        key = (self.group, self.material)
        self.lines.setdefault(key, line)
        part = self.parts.setdefault(key, [])
        with located(file=self.file, line=line):
            part += self._triangles(corner.astype(np.int64), words)

    def _triangles(
        self, corner: Int[np.ndarray, " corners"], words: Int[np.ndarray, " faces"]
    ) -> list[np.ndarray]:
        # Faces with equal numbers of corners are converted together
        first = np.cumsum(words) - words
        made = []
        for count in np.unique(words).tolist():
            chosen = first[words == count]
            faces = corner[chosen[:, None] + np.arange(count)]
            made.append(faces if count == 3 else self._cut(faces))
        return made

    def _cut(self, faces: Int[np.ndarray, "faces corners"]) -> np.ndarray:
        # Convex and self-intersecting faces: triangle fans; concave faces: ear cutting
        points = self._points()[faces]
        steps = np.arange(1, faces.shape[1] - 1)
        fan = np.stack([np.zeros_like(steps), steps, steps + 1], axis=1)
        made = []
        bent = np.flatnonzero(~_convex(points))
        fanned = np.ones(len(faces), dtype=bool)
        for i in bent.tolist():
            ears = simple_faces(points[i])
            if ears is not None:
                fanned[i] = False
                made.append(faces[i][ears])
        return np.concatenate([faces[fanned][:, fan].reshape(-1, 3), *made])

    def _points(self) -> Float[np.ndarray, "vertices 3"]:
        if len(self.vertices) > 1:
            self.vertices = [np.concatenate(self.vertices)]
        return self.vertices[0] if self.vertices else np.empty((0, 3))

    def add_lines(self, text: bytes, line: int) -> None:
        for i, raw in enumerate(text.split(b"\n")):
            words = raw.decode("utf-8", errors="replace").split()
            match words[:1]:
                case ["g" | "o"]:
                    self.group = " ".join(words[1:])
                case ["usemtl"]:
                    self.material = " ".join(words[1:])
                case ["mtllib"]:
                    self.libraries.append(" ".join(words[1:]))
                case ["v"] | ["f"]:
                    # Vertex or face with blanks before the keyword
                    one = np.frombuffer((" ".join(words) + "\n").encode(), np.uint8)
                    add = self.add_vertices if words[0] == "v" else self.add_faces
                    add(one, line + i)
                case [word]:
                    # Smoothing, lines, points and curves are ignored
                    message = "the file is not text; a Wavefront OBJ text file expected"
                    valid = word.isprintable()
                    require(valid, message, file=self.file, line=line + i)

    def _numbers(
        self, letters: UInt8[np.ndarray, " bytes"], line: int
    ) -> tuple[Float[np.ndarray, " numbers"], Int[np.ndarray, " lines"]]:
        # All numbers after the keywords, and the count of numbers on each line
        blank = _SPACES[letters]
        begins = np.flatnonzero(~blank & np.append(True, blank[:-1]))
        ends = np.flatnonzero(letters == ord("\n"))
        words = np.diff(np.searchsorted(begins, ends), prepend=0) - 1
        text = letters.copy()
        text[np.append(0, ends[:-1] + 1)] = ord(" ")
        try:
            # Some versions of NumPy warn about malformed numbers, others raise an error
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)
                values = np.fromstring(text.tobytes().decode("latin-1"), sep=" ")
        except ValueError:
            raise self._bad_number(text.tobytes(), line) from None
        if len(values) != words.sum():
            raise self._bad_number(text.tobytes(), line)
        return values, words

    def _bad_number(self, text: bytes, line: int) -> InputError:
        message = "a number cannot be read"
        for at, raw in enumerate(text.split(b"\n"), line):
            for word in raw.split():
                try:
                    float(word)
                except ValueError:
                    shown = word[:40].decode("latin-1")
                    message = f'"{shown}" is found where a number is expected'
                    return InputError(message, file=self.file, line=at)
        return InputError(message, file=self.file, line=line)

    def result(self) -> ObjText:
        parts = tuple(
            ObjPart(group, material, np.concatenate(faces), self.lines[group, material])
            for (group, material), faces in self.parts.items()
        )
        return ObjText(self._points(), parts, tuple(self.libraries))


def _without_slashes(
    letters: UInt8[np.ndarray, " bytes"],
) -> UInt8[np.ndarray, " bytes"]:
    # Blank out the text from a slash to the next blank, to leave vertex indices only
    slash = letters == ord("/")
    if not slash.any():
        return letters
    place = np.arange(len(letters), dtype=np.int32)
    last_slash = np.maximum.accumulate(np.where(slash, place, -1))
    last_blank = np.maximum.accumulate(np.where(_SPACES[letters], place, -1))
    return np.where(last_slash > last_blank, np.uint8(ord(" ")), letters)


def _convex(points: Float[np.ndarray, "faces corners 3"]) -> Bool[np.ndarray, " faces"]:
    # Whether all corners and fan triangles turn in the same sense as the face
    edge = np.roll(points, -1, axis=1) - points
    turn = np.cross(np.roll(edge, 1, axis=1), edge)
    spoke = points[:, 1:] - points[:, :1]
    fan = np.cross(spoke[:, :-1], spoke[:, 1:])
    sides = np.concatenate([turn, fan], axis=1)
    convex: np.ndarray = np.all(
        np.einsum("fcx,fx->fc", sides, fan.sum(axis=1)) >= 0, axis=1
    )
    return convex
