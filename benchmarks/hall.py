"""A hall of any size for benchmarks: walls, windows, a space frame, and sensors."""

from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.directions import Frame
from clerestory.hemisphere.klems import klems
from clerestory.scene.model import Polygon, TriangleMesh

# The hall [m], its sensors' height, and the least distance of sensors to walls
LENGTH, DEPTH, HEIGHT = 200.0, 60.0, 10.0
DESK, EDGE = 0.8, 1.0
SILL, HEAD, POST = 0.5, 8.5, 0.5


def quad(corners: list, name: str) -> Polygon:
    """Return a grey polygon."""
    return Polygon(np.array(corners, dtype=float), "grey", name)


def facade(windows: int) -> tuple[list[Polygon], list[cl.Window]]:
    """Return the walls around the windows of both long sides, and the windows."""
    walls, groups = [], []
    for side, y in enumerate((0.0, DEPTH)):
        count = windows - windows // 2 if side == 0 else windows // 2
        inward = np.array([0.0, 1.0 - 2 * side, 0.0])
        for low, high in ((0.0, SILL), (HEAD, HEIGHT)):
            walls.append(
                quad(
                    [[0, y, low], [LENGTH, y, low], [LENGTH, y, high], [0, y, high]],
                    "wall",
                )
            )
        width = LENGTH / max(count, 1)
        for number in range(count):
            a, b = number * width + POST / 2, (number + 1) * width - POST / 2
            for left, right in ((number * width, a), (b, (number + 1) * width)):
                walls.append(
                    quad(
                        [[left, y, SILL], [right, y, SILL], [right, y, HEAD],
                         [left, y, HEAD]],
                        "post",
                    )
                )  # fmt: skip
            corners = [[a, y, SILL], [a, y, HEAD], [b, y, HEAD], [b, y, SILL]]
            pane = quad(corners if side == 0 else corners[::-1], "pane")
            frame = Frame.from_normal_up(inward, np.array([0.0, 0.0, 1.0]))
            name = f"{'south' if side == 0 else 'north'}{number}"
            groups.append(cl.Window(name, (pane,), frame, klems("full")))
    return walls, groups


def shell() -> list[Polygon]:
    """Return floor, ceiling, ends of the hall, and the ground outside."""
    x, y, z = LENGTH, DEPTH, HEIGHT
    far = 500.0
    return [
        quad([[0, 0, 0], [x, 0, 0], [x, y, 0], [0, y, 0]], "floor"),
        quad([[0, 0, z], [0, y, z], [x, y, z], [x, 0, z]], "ceiling"),
        quad([[0, 0, 0], [0, y, 0], [0, y, z], [0, 0, z]], "west"),
        quad([[x, 0, 0], [x, 0, z], [x, y, z], [x, y, 0]], "east"),
        quad(
            [[-far, -far, -0.1], [far, -far, -0.1], [far, far, -0.1],
             [-far, far, -0.1]],
            "ground",
        ),
    ]  # fmt: skip


def space_frame(triangles: int) -> TriangleMesh:
    """Return the nodes of a space frame below the ceiling: balls of 1520 triangles."""
    rows, around = 20, 40
    theta = np.linspace(0, np.pi, rows + 1)
    phi = np.arange(around) * 2 * np.pi / around
    ball = np.stack(
        [
            np.outer(np.sin(theta), np.cos(phi)),
            np.outer(np.sin(theta), np.sin(phi)),
            np.outer(np.cos(theta), np.ones(around)),
        ],
        axis=-1,
    ).reshape(-1, 3)
    i, j = np.meshgrid(np.arange(rows), np.arange(around), indexing="ij")
    a, b = i * around + j, i * around + (j + 1) % around
    faces = np.concatenate(
        [
            np.stack([a, a + around, b], -1)[1:].reshape(-1, 3),
            np.stack([b, a + around, b + around], -1)[:-1].reshape(-1, 3),
        ]
    )
    count = max(1, round(triangles / len(faces)))
    rng = np.random.default_rng(1)
    low, high = [1, 1, HEAD], [LENGTH - 1, DEPTH - 1, HEIGHT - 0.3]
    centres = rng.uniform(low, high, (count, 3))
    vertices = (0.1 * ball + centres[:, None]).reshape(-1, 3)
    every = faces + (np.arange(count) * len(ball))[:, None, None]
    return TriangleMesh(vertices, every.reshape(-1, 3), "grey", "space frame")


def sensors_of(count: int) -> cl.Sensors:
    """Return a grid over the floor that looks up."""
    step = np.sqrt((LENGTH - 2 * EDGE) * (DEPTH - 2 * EDGE) / count)
    rows = max(1, round((DEPTH - 2 * EDGE) / step))
    x = np.linspace(EDGE, LENGTH - EDGE, -(-count // rows))
    y = np.linspace(EDGE, DEPTH - EDGE, rows)
    grid = np.stack(np.meshgrid(x, y, indexing="ij"), -1).reshape(-1, 2)[:count]
    position = np.column_stack([grid, np.full(len(grid), DESK)])
    return cl.Sensors(position, np.tile([0.0, 0.0, 1.0], (len(grid), 1)))


def polygon_text(material: str, number: int, polygon: Polygon) -> str:
    """Return a polygon as Radiance writes it."""
    numbers = " ".join(f"{x:.9g}" for x in polygon.vertices.ravel())
    name = f"{material}.{polygon.name}.{number}"
    return f"{material} polygon {name} 0 0 {polygon.vertices.size} {numbers}"


def write_obj(mesh: TriangleMesh, path: Path) -> None:
    """Write a mesh as an OBJ file."""
    with path.open("w") as file:
        file.write("usemtl grey\n")
        for form, rows in (("v %.6g %.6g %.6g\n", mesh.vertices),
                           ("f %d %d %d\n", mesh.faces + 1)):  # fmt: skip
            for first in range(0, len(rows), 100_000):
                part = rows[first : first + 100_000]
                file.write(form * len(part) % tuple(part.ravel().tolist()))
