"""A room behind four systems: pictures through a tree and through the geometry.

    python benchmarks/tree_picture.py [--columns 96] [--samples 256] [--halvings 5]
        [--paths 16384] [--systems blind-0 …] [--figure PNG] [--write FILE]

A room of 3 × 4 × 2.8 m with one window to the south, a system before it, a low sun and
an even sky. One picture meets the geometry, the other a surface with the tree that was
traced from it. What is seen of the room is compared, block by block of pixels, larger
than the stripes that slats throw; the window is left out.

A tree has one value for all directions of a cell, the mean over them. The geometry is
therefore shown twice: under the sun, and under the same light spread evenly over the
tree's cell that the sun stands in. The second is what a tree without fault shows; what
the first differs from it is the price of its cells. Of N paths from each incident cell
T·N leave through the sun's: what comes from there is known to 1/√(T·N) only, all over
the picture. Light of the sun through a film can only be met by chance: the film has a
disc of 60° with the light of the sun instead.

Microlouvre and film are enlarged: nothing but proportions matters to a tree.
"""

import argparse
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import matplotlib as mpl
import matplotlib.pyplot as plt
import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.bsdfgen.film_geometry import prismatic
from clerestory.bsdfgen.shading_system import System
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.hemisphere.shirley_chiu import disc_from_square, square_from_disc
from clerestory.scene.model import BsdfSurface, Polygon, Scene

# Half of the window's width, its lower and upper edge, and how far systems reach on.
HALF, SILL, HEAD, BEYOND = 0.72, 0.9, 2.34, 0.72
BLOCK = 8

# The sun stands in the cell that holds this direction (x, z), off the cell's middle,
# but with its whole disc inside.
NEAR, OFF = (0.25, 0.36), 0.3
DISC_DEG, RADIANCE = 0.533, 2e6

# Suns along each side of a cell: at 2^5 cells an axis, discs of its size touch.
SPREAD = 8
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
SKY = """void glow sky 0 0 4 4 4 4 0
sky source dome 0 0 4 0 0 1 360
"""
LIGHT = """void light solar{n} 0 0 3 {r} {r} {r}
solar{n} source sun{n} 0 0 4 {x} {y} {z} {wide}
"""


def _blind(tilt_deg: float) -> System:
    return venetian(slat_width=0.08, spacing=0.072, tilt_deg=tilt_deg, reflectance=0.48)


def _louvre() -> System:
    return microlouvre(depth=0.02, thickness=0.00352)


def _film() -> System:
    return prismatic(pitch=0.02, base=0.02)


@dataclass(frozen=True)
class Case:
    """A system with its light.

    Attributes
    ----------
    name : for the table
    make : makes the system
    wide_deg : of the disc that lights it
    """

    name: str
    make: Callable[[], System]
    wide_deg: float = DISC_DEG

    @property
    def spread(self) -> bool:
        """Whether the light is also spread over the tree's cell."""
        return self.wide_deg == DISC_DEG


CASES = {
    "blind-0": Case("blind, 0°", lambda: _blind(0)),
    "blind-45": Case("blind, 45°", lambda: _blind(45)),
    "microlouvre": Case("microlouvre", _louvre),
    "film": Case("prismatic film", _film, wide_deg=60.0),
}


@dataclass(frozen=True)
class Pair:
    """The room seen both ways.

    Attributes
    ----------
    name : of the system
    light : what lights the geometry
    geometry, tree : luminance of the pixels [cd/m²]
    error : standard error of the ratio of block means
    ratio : tree over geometry, by block; not a number at the window
    cells : values of the tree's transmission
    """

    name: str
    light: str
    geometry: np.ndarray
    tree: np.ndarray
    error: np.ndarray
    ratio: np.ndarray
    cells: int


def room(light: str) -> Scene:
    """Return the room with its hole, black outside, and the light."""
    a, b = SILL, HEAD
    parts = [ROOM, SKY, light]
    for material, y in (("white", 0.0), ("black", -2e-4)):
        hole = [(HALF, 0), (HALF, b), (-HALF, b), (-HALF, a), (HALF, a), (HALF, 0)]
        outline = [(-1.5, 0), (-1.5, 2.8), (1.5, 2.8), (1.5, 0), *hole]
        corners = " ".join(f"{x} {y} {z}" for x, z in outline)
        parts.append(WALL.format(material=material, corners=corners))
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "room.rad"
        path.write_text("".join(parts))
        return cl.read_rad(path)


def in_cell(halvings: int, first: float, second: float) -> np.ndarray:
    """Return a direction in the sun's cell, by shares of the cell's edges."""
    edge = 1 << halvings
    corner = np.floor(np.array(square_from_disc(*NEAR)) * edge)
    x, z = disc_from_square(*((corner + np.array([first, second])) / edge))
    return np.array([x, -np.sqrt(1 - x * x - z * z), z])


def disc(wide_deg: float, halvings: int) -> str:
    """Return a disc in the sun's place with the light of the sun."""
    dimmer = np.sin(np.radians([DISC_DEG / 2, wide_deg / 2])) ** 2
    r = RADIANCE * dimmer[0] / dimmer[1]
    x, y, z = in_cell(halvings, OFF, OFF)
    return LIGHT.format(n=0, r=r, x=x, y=y, z=z, wide=wide_deg)


def spread_sun(halvings: int) -> str:
    """Return suns that light the window from all over the cell of the sun alike."""
    level = in_cell(halvings, OFF, OFF)[1]
    lines = []
    for n, place in enumerate(np.ndindex(SPREAD, SPREAD)):
        x, y, z = in_cell(halvings, *((np.array(place) + 0.5) / SPREAD))
        r = RADIANCE / SPREAD**2 * level / y
        lines.append(LIGHT.format(n=n, r=r, x=x, y=y, z=z, wide=DISC_DEG))
    return "".join(lines)


def before_window(system: System) -> Scene:
    """Return a system that is drawn along x, repeated before the window and beyond."""
    high, wide = (HEAD - SILL) / 2 + BEYOND, HALF + BEYOND
    front = system.area.bounds[1, 2] + 4e-4
    placed = []
    for part, shift in _repeated(system, high):
        x, y, z = part.vertices.T
        x = np.where(x < x.mean(), wide, -wide)
        up = y + shift if np.ptp(y) < 2 * high else np.clip(y, -high, high)
        corners = np.stack([x, z - front, up + (SILL + HEAD) / 2], axis=1)
        placed.append(replace(part, vertices=corners))
    return replace(system.scene, surfaces=tuple(placed))


def _repeated(system: System, high: float) -> list[tuple[Polygon, float]]:
    # Polygons of one period with their shifts, and a sheet as high as all of them
    size = float(system.area.size[1])
    found = []
    for part in system.scene.surfaces:
        y = part.vertices[:, 1]
        if np.ptp(y) > size:
            tall = part.vertices * [1, 1e3, 1] - [0, 500 * size, 0]
            found.append((replace(part, vertices=tall), 0.0))
        elif 0 <= y.mean() < size:
            turns = range(-int(high / size) - 2, int(high / size) + 2)
            shifts = [turn * size for turn in turns]
            found += [(part, s) for s in shifts if abs(y.mean() + s) < high]
    return found


def behind_tree(system: System, halvings: int, paths: int) -> tuple[Scene, int]:
    """Return the system's tree as a surface in the window, and the tree's size.

    Parameters
    ----------
    paths : from each incident cell
    """
    bsdf = cl.generate_bsdf(system, basis="tree4", halvings=halvings, samples=paths)
    cells = bsdf.functions["visible", "transmission_back"]
    return window(bsdf), int(np.count_nonzero(cells.slots >= 0))


def window(bsdf: cl.Bsdf) -> Scene:
    """Return the window with a layer in it."""
    layer = BsdfSurface("layer", bsdf, 0.0, np.array([0.0, 0, 1]))
    corners = [(-HALF, SILL), (-HALF, HEAD), (HALF, HEAD), (HALF, SILL)]
    pane = np.array([(x, 0.0, z) for x, z in corners])
    return Scene({"layer": layer}, (Polygon(pane, "layer", "window"),))


def compare(
    case: Case, columns: int, samples: int, *, halvings: int, paths: int
) -> list[Pair]:
    """Render the pictures and compare them."""
    view = cl.parse_view(VIEW)
    size = dict(zip(("columns", "rows"), view.size_for(columns), strict=True))
    size = {name: BLOCK * (count // BLOCK) for name, count in size.items()}
    system = case.make()
    layer, cells = behind_tree(system, halvings, paths)
    parts = before_window(system)
    own = disc(case.wide_deg, halvings)
    lights = {"sun" if case.spread else f"disc of {case.wide_deg:.0f}°": own}
    if case.spread:
        lights["sun over its cell"] = spread_sun(halvings)

    def seen(scene: Scene, seed: int) -> tuple[np.ndarray, np.ndarray]:
        made = cl.render(scene, view, **size, samples=samples, seed=seed)
        return made.picture.luminance(), 179 * made.error.mean(axis=2)

    tree = seen(room(own) + layer, 1)
    inside = _looks_at_room(view, **size)
    pairs = []
    for seed, (light, text) in enumerate(lights.items(), 2):
        geometry = seen(room(text) + parts, seed)
        means, errors = zip(
            *(
                (
                    _blocks(np.where(inside, mean, np.nan)),
                    np.sqrt(_blocks(np.where(inside, error**2, np.nan))) / BLOCK,
                )
                for mean, error in (geometry, tree)
            ),
            strict=True,
        )
        relative = np.hypot(errors[0] / means[0], errors[1] / means[1])
        ratio = means[1] / means[0]
        pairs.append(
            Pair(case.name, light, geometry[0], tree[0], relative, ratio, cells)
        )
    return pairs


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
        most = float(np.quantile(pair.geometry, 0.98))
        scale = mpl.colors.PowerNorm(0.45, 0, most)
        titles = f"{pair.name}: geometry, {pair.light}", f"{pair.name}: tree"
        for axis, picture, title in zip(
            row, (pair.geometry, pair.tree), titles, strict=False
        ):
            shown = axis.imshow(picture, norm=scale, cmap="gray")
            axis.set_title(title, fontsize=10)
        figure.colorbar(shown, ax=row[:2], label="cd/m²", shrink=0.8)
        ratio = mpl.colors.LogNorm(0.8, 1.25)
        map_ = row[2].imshow(pair.ratio, norm=ratio, cmap="RdBu_r")
        row[2].set_title("tree over geometry, blocks of 8 × 8", fontsize=10)
        bar = figure.colorbar(
            map_, ax=row[2], shrink=0.8, ticks=[0.8, 0.9, 1, 1.1, 1.25]
        )
        bar.ax.set_yticklabels(["0.8", "0.9", "1", "1.1", "1.25"])
        bar.ax.minorticks_off()
        for axis in row:
            axis.set_xticks([])
            axis.set_yticks([])
    figure.savefig(path, dpi=110)


def table(pairs: list[Pair], halvings: int, paths: int) -> str:
    """Return the figures as Markdown."""
    lines = [
        "# Pictures through a tree and through its geometry",
        "",
        f"{stamp()}; trees of 2^{halvings} cells an axis from {paths} paths a cell,"
        f" blocks of {BLOCK} × {BLOCK} pixels, the window left out.",
        "",
        "| system | light on the geometry | cells | mean, tree over geometry"
        " | blocks off, median | 90 % within | noise of a block, median"
        " | off by more than 3 times its noise and 5 %"
        " | correlation of log luminance |",
        "|---|---|---|---|---|---|---|---|---|",
    ]
    for pair in pairs:
        known = np.isfinite(pair.ratio)
        off = np.abs(pair.ratio[known] - 1)
        blocks = _blocks(pair.geometry)[known]
        far = off > np.maximum(3 * pair.error[known], 0.05)
        both = np.corrcoef(np.log(blocks), np.log(blocks * pair.ratio[known]))[0, 1]
        mean = float((blocks * pair.ratio[known]).sum() / blocks.sum())
        lines.append(
            f"| {pair.name} | {pair.light} | {pair.cells:,} | {mean:.3f}"
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
    parser.add_argument("--samples", type=int, default=256)
    parser.add_argument("--halvings", type=int, default=5)
    parser.add_argument("--paths", type=int, default=1 << 14, help="a tree's cell")
    parser.add_argument("--systems", nargs="+", choices=CASES, default=list(CASES))
    parser.add_argument("--figure", type=Path, help="picture to write")
    parser.add_argument("--write", type=Path, help="Markdown file to write")
    options = parser.parse_args()
    pairs: list[Pair] = []
    for name in options.systems:
        pairs += compare(
            CASES[name], options.columns, options.samples,
            halvings=options.halvings, paths=options.paths,
        )  # fmt: skip
        print(table(pairs, options.halvings, options.paths), flush=True)
    text = table(pairs, options.halvings, options.paths)
    if options.figure:
        draw(pairs, options.figure)
    if options.write:
        options.write.write_text(text)


if __name__ == "__main__":
    main()
