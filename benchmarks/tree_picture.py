"""A room behind a blind: pictures through its tree and through its geometry.

    python benchmarks/tree_picture.py [--columns 96] [--samples 1024] [--halvings 6]
        [--figure PNG] [--write FILE]

A room of 3 × 4 × 2.8 m with one window to the south, a blind of flat slats before it,
a low sun and an even sky. One picture meets the slats, the other a surface with the
tree that was traced from them. What is seen of the room is compared, block by block of
pixels, larger than the stripes that slats throw; the window is left out. A tree blurs
the edge of the sun's patch by the width of its cells, which the slats do not.
"""

import argparse
import tempfile
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.bsdfgen.slats import venetian
from clerestory.scene.model import BsdfSurface, Polygon, Scene

# Half of the window's width, its lower and its upper edge, and how far slats reach on.
HALF, SILL, HEAD, BEYOND = 0.72, 0.9, 2.34, 0.72
SPACING = 0.072
BLOCK = 8
SUN = np.array([0.25, -0.9, 0.36])
VIEW = "-vtv -vp -1.3 0.3 1.7 -vd 0.5 1 -0.35 -vu 0 0 1 -vh 82 -vv 66"
ROOM = """void plastic white 0 0 5 .7 .7 .7 0 0
void plastic grey 0 0 5 .3 .3 .3 0 0
void plastic black 0 0 5 0 0 0 0 0
grey polygon floor 0 0 12 -1.5 0 0  1.5 0 0  1.5 4 0  -1.5 4 0
white polygon ceiling 0 0 12 -1.5 0 2.8  -1.5 4 2.8  1.5 4 2.8  1.5 0 2.8
white polygon west 0 0 12 -1.5 0 0  -1.5 4 0  -1.5 4 2.8  -1.5 0 2.8
white polygon east 0 0 12 1.5 0 0  1.5 0 2.8  1.5 4 2.8  1.5 4 0
white polygon north 0 0 12 -1.5 4 0  1.5 4 0  1.5 4 2.8  -1.5 4 2.8
"""
WALL = "{material} polygon {material}_wall 0 0 30 {corners}\n"
LIGHT = """void glow sky 0 0 4 4 4 4 0
sky source dome 0 0 4 0 0 1 360
void light solar 0 0 3 2e6 2e6 2e6
solar source sun 0 0 4 {} {} {} 0.533
"""


@dataclass(frozen=True)
class Pair:
    """The room seen both ways.

    Attributes
    ----------
    tilt_deg : of the slats
    slats, tree : luminance of the pixels [cd/m²]
    error : standard error of the ratio of block means
    ratio : tree over slats, by block; not a number at the window
    cells : values of the tree's transmission
    """

    tilt_deg: float
    slats: np.ndarray
    tree: np.ndarray
    error: np.ndarray
    ratio: np.ndarray
    cells: int


def room() -> Scene:
    """Return the room with its hole, black outside, and the light."""
    a, b = SILL, HEAD
    parts = [ROOM, LIGHT.format(*(SUN / np.linalg.norm(SUN)))]
    for material, y in (("white", 0.0), ("black", -2e-4)):
        hole = [(HALF, 0), (HALF, b), (-HALF, b), (-HALF, a), (HALF, a), (HALF, 0)]
        outline = [(-1.5, 0), (-1.5, 2.8), (1.5, 2.8), (1.5, 0), *hole]
        corners = " ".join(f"{x} {y} {z}" for x, z in outline)
        parts.append(WALL.format(material=material, corners=corners))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "room.rad"
        path.write_text("".join(parts))
        return cl.read_rad(path)


def behind_slats(tilt_deg: float) -> Scene:
    """Return the room with the slats before its window."""
    count = round((HEAD - SILL + 2 * BEYOND) / SPACING)
    blind = venetian(**_shape(tilt_deg), slats=count, length=2 * (HALF + BEYOND))
    low, high = blind.area.bounds
    middle = np.array([*(low + high)[:2] / 2, high[2] + 4e-4])
    scene = replace(blind.scene, surfaces=())
    placed = []
    for slat in blind.scene.surfaces:
        x, y, z = (slat.vertices - middle).T
        corners = np.stack([-x, z, y + (SILL + HEAD) / 2], axis=1)
        placed.append(replace(slat, vertices=corners))
    return room() + replace(scene, surfaces=tuple(placed))


def behind_tree(tilt_deg: float, halvings: int) -> tuple[Scene, int]:
    """Return the room with the blind's tree in its window, and the tree's size."""
    bsdf = cl.generate_bsdf(
        venetian(**_shape(tilt_deg)), basis="tree4", halvings=halvings, samples=256
    )
    layer = BsdfSurface("blind", bsdf, 0.0, np.array([0.0, 0, 1]))
    corners = [(-HALF, SILL), (-HALF, HEAD), (HALF, HEAD), (HALF, SILL)]
    pane = np.array([(x, 0.0, z) for x, z in corners])
    window = Scene({"blind": layer}, (Polygon(pane, "blind", "window"),))
    cells = bsdf.functions["visible", "transmission_back"]
    return room() + window, int(np.count_nonzero(cells.slots >= 0))


def _shape(tilt_deg: float) -> dict[str, float]:
    return {
        "slat_width": 0.08,
        "spacing": SPACING,
        "tilt_deg": tilt_deg,
        "reflectance": 0.48,
    }


def compare(tilt_deg: float, columns: int, samples: int, halvings: int) -> Pair:
    """Render both pictures and compare them."""
    view = cl.parse_view(VIEW)
    size = dict(zip(("columns", "rows"), view.size_for(columns), strict=True))
    size = {name: BLOCK * (count // BLOCK) for name, count in size.items()}
    scene, cells = behind_tree(tilt_deg, halvings)
    made = [
        cl.render(one, view, **size, samples=samples, seed=seed)
        for seed, one in ((1, behind_slats(tilt_deg)), (2, scene))
    ]
    seen = [one.picture.luminance() for one in made]
    noise = [179 * one.error.mean(axis=2) for one in made]
    room_seen = _looks_at_room(view, **size)
    means = [_blocks(np.where(room_seen, part, np.nan)) for part in seen]
    errors = [
        np.sqrt(_blocks(np.where(room_seen, part**2, np.nan))) / BLOCK for part in noise
    ]
    relative = np.hypot(errors[0] / means[0], errors[1] / means[1])
    return Pair(tilt_deg, *seen, relative, means[1] / means[0], cells)


def _looks_at_room(view: "cl.View", *, columns: int, rows: int) -> np.ndarray:
    rays = view.rays(columns, rows)
    way = -rays.origin[..., 1] / np.minimum(rays.direction[..., 1], -1e-9)
    x, _, z = np.moveaxis(rays.origin + way[..., None] * rays.direction, -1, 0)
    inside = (np.abs(x) < HALF) & (z > SILL) & (z < HEAD) & (rays.direction[..., 1] < 0)
    return ~inside


def _blocks(pixels: np.ndarray) -> np.ndarray:
    rows, columns = pixels.shape
    cut = pixels.reshape(rows // BLOCK, BLOCK, columns // BLOCK, BLOCK)
    return cut.mean(axis=(1, 3))


def draw(pairs: list[Pair], path: Path) -> None:
    """Draw the pictures and their ratio."""
    figure, axes = plt.subplots(
        len(pairs), 3, figsize=(10, 2.7 * len(pairs)), layout="constrained"
    )
    for pair, row in zip(pairs, np.atleast_2d(axes), strict=True):
        most = float(np.quantile(pair.slats, 0.98))
        scale = mpl.colors.PowerNorm(0.45, 0, most)
        for axis, picture, title in zip(
            row, (pair.slats, pair.tree), ("slats", "tree"), strict=False
        ):
            shown = axis.imshow(picture, norm=scale, cmap="gray")
            axis.set_title(f"{title}, tilt {pair.tilt_deg:.0f}°")
        figure.colorbar(shown, ax=row[:2], label="cd/m²", shrink=0.8)
        ratio = mpl.colors.LogNorm(0.8, 1.25)
        map_ = row[2].imshow(pair.ratio, norm=ratio, cmap="RdBu_r")
        row[2].set_title("tree over slats, blocks of 8 × 8")
        bar = figure.colorbar(
            map_, ax=row[2], shrink=0.8, ticks=[0.8, 0.9, 1, 1.1, 1.25]
        )
        bar.ax.set_yticklabels(["0.8", "0.9", "1", "1.1", "1.25"])
        bar.ax.minorticks_off()
        for axis in row:
            axis.set_xticks([])
            axis.set_yticks([])
    figure.savefig(path, dpi=110)


def table(pairs: list[Pair], halvings: int) -> str:
    """Return the figures as Markdown."""
    lines = [
        "# Pictures through a tree and through its geometry",
        "",
        f"{stamp()}; trees of 2^{halvings} cells an axis, blocks of {BLOCK} × {BLOCK}"
        " pixels, the window left out.",
        "",
        "| tilt | cells | mean, tree over slats | blocks off, median | 90 % within"
        " | noise of a block, median | off by more than 3 times its noise and 5 %"
        " | correlation of log luminance |",
        "|---|---|---|---|---|---|---|---|",
    ]
    for pair in pairs:
        known = np.isfinite(pair.ratio)
        off = np.abs(pair.ratio[known] - 1)
        blocks = _blocks(pair.slats)[known]
        far = off > np.maximum(3 * pair.error[known], 0.05)
        both = np.corrcoef(np.log(blocks), np.log(blocks * pair.ratio[known]))[0, 1]
        mean = float((blocks * pair.ratio[known]).sum() / blocks.sum())
        lines.append(
            f"| {pair.tilt_deg:.0f}° | {pair.cells:,} | {mean:.3f}"
            f" | {np.median(off):.3f} | {np.quantile(off, 0.9):.3f}"
            f" | {np.nanmedian(pair.error):.3f}"
            f" | {far.sum()} of {len(off)}"
            f" | {both:.4f} |"
        )
    return "\n".join(lines) + "\n"


def main() -> None:
    """Read the command line, render, draw and print."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--columns", type=int, default=96)
    parser.add_argument("--samples", type=int, default=1024)
    parser.add_argument("--halvings", type=int, default=6)
    parser.add_argument("--tilts", type=float, nargs="+", default=[0.0, 45.0])
    parser.add_argument("--figure", type=Path, help="picture to write")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    pairs = [
        compare(tilt, options.columns, options.samples, options.halvings)
        for tilt in options.tilts
    ]
    text = table(pairs, options.halvings)
    print(text)
    if options.figure:
        draw(pairs, options.figure)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
