"""Rooms that both programs read: the reference room, the demo's, finely cut ones."""

import shutil
import tempfile
from dataclasses import dataclass
from importlib import resources
from pathlib import Path

import numpy as np

import clerestory as cl
from clerestory.scene.model import Scene
from clerestory.scene.tessellate import meshes

SHARED = Path(__file__).parents[2] / "shared" / "data" / "tutorial_room"


@dataclass(frozen=True)
class Room:
    """A room in a folder, with one window and points.

    Attributes
    ----------
    name : for tables
    folder : where its files lie
    files : scene files, in order
    window, points : files
    """

    name: str
    folder: Path
    files: tuple[Path, ...]
    window: Path
    points: Path

    def scene(self) -> Scene:
        """Return the scene."""
        return cl.read_rad(*self.files)


def room(folder: Path) -> Room:
    """Return LBNL's tutorial room where it is at hand, else the demo's room."""
    if SHARED.is_dir():
        # Copy it: its files name each other relative to their folder
        home = folder / "tutorial_room"
        shutil.copytree(SHARED, home, dirs_exist_ok=True)
        files = (home / "materials.rad", home / "room.rad")
        window = home / "objects" / "GlazingVmtx.rad"
        return Room("tutorial room", home, files, window, home / "points.txt")
    home = folder / "demo"
    with resources.as_file(resources.files("clerestory") / "demo") as source:
        shutil.copytree(source, home, dirs_exist_ok=True)
    files = (home / "materials.rad", home / "room.rad")
    return Room("demo room", home, files, home / "window.rad", home / "desks.pts")


def finely_cut(original: Room, triangles: int) -> Room:
    """Return the same room with its surfaces cut into at least so many triangles."""
    scene = original.scene()
    lines = []
    for key, material in scene.materials.items():
        colour = " ".join(f"{c:.6g}" for c in getattr(material, "reflectance", [0] * 3))
        lines.append(f"void plastic {key} 0 0 5 {colour} 0 0")
    corners = [(m.material.name, m.vertices[m.faces]) for m in meshes(scene)]
    rounds = 0
    while sum(len(c) for _, c in corners) * 4**rounds < triangles:
        rounds += 1
    for name, triangle in corners:
        cut = triangle
        for _ in range(rounds):
            cut = _quarter(cut)
        for number, t in enumerate(cut):
            place = " ".join(f"{x:.7g}" for x in t.ravel())
            lines.append(f"{name} polygon {name}_{number} 0 0 9 {place}")
    path = original.folder / f"cut_{triangles}.rad"
    path.write_text("\n".join(lines) + "\n")
    count = sum(len(c) for _, c in corners) * 4**rounds
    name = f"{original.name}, {count:,} triangles"
    return Room(name, original.folder, (path,), original.window, original.points)


def _quarter(t: np.ndarray) -> np.ndarray:
    # Each triangle into four, through the middles of its sides
    a, b, c = t[:, 0], t[:, 1], t[:, 2]
    ab, bc, ca = (a + b) / 2, (b + c) / 2, (c + a) / 2
    parts = [(a, ab, ca), (ab, b, bc), (ca, bc, c), (ab, bc, ca)]
    return np.concatenate([np.stack(p, axis=1) for p in parts])


def workplace() -> Path:
    """Return a temporary folder for files and octrees."""
    return Path(tempfile.mkdtemp(prefix="clerestory-bench-"))
