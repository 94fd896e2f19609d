"""Radiance's side of LBNL's five-phase tutorial: every matrix of its script `5PM.sh`.

The recipe is the tutorial's, step by step, with three changes that leave its meaning:
paths are not cut by their weight (`-lw`), which loses light; the suns are those of the
MF 6 patches that occur, each with a modifier of its own; eq. (4) and (5), illuminance
times material map, are taken ray by ray and not pixel by pixel. The blind is a surface
with a BSDF, no proxy, so that both programs are asked for the same thing; a strip
closes the gap that the tutorial's room has below its pane.
"""

import hashlib
import os
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from radiance import ENVIRONMENT

PATCHES = 145
SUN_SR = 2 * np.pi * (1 - np.cos(np.radians(0.533 / 2)))
SUN_RADIANCE = 1e6
SILL = 0.904875

# Contributions, not coefficients (-V+): behind a BSDF rcontrib 6.0a loses most of the
# coefficients of suns; its contributions are what rtrace says
SUN = "-n 2 -h- -w- -V+ -lw 1e-9 -dc 1 -dt 0 -dj 1"

# Rays of a sensor to each sun: over its disc (-dj 1), not to its middle
REPEATS = 16

# A folder that survives a test session, for work on these tests
KEPT = "CLERESTORY_RADIANCE_CACHE"


def strata(directions: int, run: int) -> int:
    """Return about as many directions (`-ad`), cut in another way for each run.

    Radiance throws one ray into each cell of a square grid laid over the hemisphere,
    and throws again where two come close to each other, so that rays shun the sides
    of cells. What lies along a side is then over- or underrated, by all runs of one
    grid alike: they agree better with each other than with what is true.
    """
    side = round(directions**0.5)
    return round(side * (1 + 0.07 * run)) ** 2


@dataclass(frozen=True)
class Effort:
    """How long Radiance works: independent runs, and the rays of each.

    Attributes
    ----------
    runs : of everything but pictures, to know its noise
    columns : of the pictures
    rays : of each pixel, the tutorial's -c 9
    jitter : share of the pixel over which its rays are spread
    view, daylight, sun, pixel : numbers of directions or samples
    """

    runs: int
    columns: int
    rays: int = 9
    jitter: float = 1.0
    view: int = 10000
    daylight: int = 4000
    sun: int = 20000
    pixel: int = 500
    pixel_direct: int = 150


@dataclass(frozen=True)
class Tutorial:
    """The tutorial's folder, copied so that files can be written beside it."""

    folder: Path
    effort: Effort

    @classmethod
    def copied(cls, source: Path, folder: Path, effort: Effort) -> "Tutorial":
        """Return a copy of the tutorial with octrees and sun sources."""
        folder.mkdir(parents=True, exist_ok=True)
        for name in ("objects", "views", "skyDomes", "matrices", "assets", "blinds"):
            shutil.copytree(source / name, folder / name, dirs_exist_ok=True)
        for file in source.glob("*.*"):
            shutil.copy(file, folder)
        for path in folder.rglob("*"):
            path.chmod(0o755 if path.is_dir() else 0o644)
        made = cls(folder, effort)
        made._write_scenes()
        return made

    def _write_scenes(self) -> None:
        strip = f"0 0.0508 0.5 6.096 0.0508 0.5 6.096 0.0508 {SILL} 0 0.0508 {SILL}"
        (self.folder / "strip.rad").write_text(f"black polygon strip 0 0 12 {strip}\n")
        suns = "".join(
            f"void light sun{i} 0 0 3 1e6 1e6 1e6\n"
            f"sun{i} source disc{i} 0 0 4 {x:.9g} {y:.9g} {z:.9g} 0.533\n"
            for i, (x, y, z) in enumerate(self.suns())
        )
        (self.folder / "suns.rad").write_text(suns)
        black = "materialBlack.rad roomBlack.rad"
        for name, files in {
            "room": "materials.rad room.rad",
            "black": black,
            "map1": "materials.rad room.rad objects/GlazingVmtx.rad",
            "map2": "materials.rad room.rad objects/GlazingVmtxBlack.rad",
        }.items():
            self.run(f"oconv {files} > {name}.oct")

    def with_bsdf(self, bsdf: Path, *, peak: bool) -> str:
        """Return the name of an octree of the black room, suns and a BSDF."""
        name = f"{bsdf.stem}{'_peak' if peak else ''}"
        pane = (self.folder / "objects" / "GlazingVmtx.rad").read_text()
        polygon = pane[pane.index("Glazing polygon") :].replace("Glazing ", "layer ", 1)
        head = "aBSDF layer 5" if peak else "BSDF layer 6 0"
        (self.folder / f"{name}.rad").write_text(
            f"void {head} {bsdf} 0 0 1 . 0 0\n{polygon}\n"
        )
        self.run(
            "oconv materialBlack.rad roomBlack.rad strip.rad suns.rad"
            f" {name}.rad > {name}.oct"
        )
        return name

    # ------------------------------- skies -------------------------------

    def sky(self, options: str) -> np.ndarray:
        """Matrix (channel, patch, time) of gendaymtx."""
        found = self.cached(f"gendaymtx -of {options} assets/NYC.wea")
        return found.transpose(2, 0, 1)

    def lit(self) -> np.ndarray:
        """Numbers of the MF 6 patches, ground excluded, in which the sun stands."""
        return np.flatnonzero(self.sky("-5 0.533 -d -m 6")[1].max(axis=1) > 0) - 1

    def suns(self) -> np.ndarray:
        """Directions to them, as reinsrc.cal has them."""
        text = self.run(
            "cnt 5185 | rcalc -e MF:6 -f reinsrc.cal -e Rbin=recno"
            " -e '$1=Dx;$2=Dy;$3=Dz'"
        )
        return np.array(text.split(), float).reshape(-1, 3)[self.lit()]

    # ----------------------- matrices, one run each ----------------------

    def view(self, run: int, *, direct: bool) -> np.ndarray:
        """V or V_d of the points (channel, sensor, patch)."""
        bounces = 1 if direct else 4
        octree = "black" if direct else "room"
        return self.matrix(
            f"rfluxmtx -n 2 -faf -h- -I+ -ab {bounces} -lw 1e-7"
            f" -ad {strata(self.effort.view, run)} -y 100"
            f" - objects/GlazingVmtx.rad -i {octree}.oct < points.txt",
            run, PATCHES,
        )  # fmt: skip

    def daylight(self, run: int, *, direct: bool) -> np.ndarray:
        """D or D_d (channel, patch, sky).

        With as many samples every run would draw the same, here and elsewhere.
        """
        bounces = "-ab 0" if direct else "-ab 4 -ad 1 -lw 1e-6"
        octree = "black" if direct else "room"
        return self.matrix(
            f"rfluxmtx -n 2 -ff -h- {bounces} -c {self.effort.daylight + 16 * run}"
            f" objects/GlazingVmtx.rad skyDomes/skyglow.rad -i {octree}.oct",
            run, PATCHES + 1,
        )  # fmt: skip

    def sun(self, run: int, octree: str) -> np.ndarray:
        """C_ds of the points (channel, sensor, sun)."""
        return self.matrix(
            f"awk '{{for (i = 0; i < {REPEATS}; i++) print}}' points.txt |"
            f" rcontrib {SUN} -faf -I+ -ab 1"
            f" -ad {strata(self.effort.sun // REPEATS, run)}"
            f" -c {REPEATS} {self._modifiers()} {octree}.oct",
            run, len(self.lit()),
        ) / SUN_RADIANCE / SUN_SR  # fmt: skip

    def shape(self, view: str) -> tuple[int, int]:
        """Columns and rows of a picture."""
        size = self.effort.columns
        words = self.run(f"vwrays -vf views/{view}.vf -x {size} -y {size} -d").split()
        return int(words[1]), int(words[3])

    def _rays(self, view: str) -> str:
        # The rays of all pixels, pixel by pixel, the same for all matrices
        name = f"{view}0.rays"
        if not (self.folder / name).exists():
            size, jitter = self.effort.columns, self.effort.jitter
            self.run(
                f"vwrays -vf views/{view}.vf -x {size} -y {size} -pj {jitter:g}"
                f" -c {self.effort.rays} -ff > {name}"
            )
        return name

    def ray_directions(self, view: str) -> np.ndarray:
        """Unit vectors of the rays (ray, 3)."""
        rays = np.fromfile(self.folder / self._rays(view), "<f4").reshape(-1, 6)
        looks = rays[:, 3:].astype(float)
        return looks / np.linalg.norm(looks, axis=1, keepdims=True)

    def pixels(self, view: str, *, direct: bool) -> np.ndarray:
        """V or V_d of a view (channel, ray, patch)."""
        rays = self._rays(view)
        octree, bounces = ("black", "-i -ab 1") if direct else ("room", "-ab 4")
        directions = self.effort.pixel_direct if direct else self.effort.pixel
        found = self.matrix(
            f"rfluxmtx -n 2 -ff -h- {bounces} -ad {directions} -lw 1e-5"
            f" - objects/GlazingVmtx.rad -i {octree}.oct < {rays}",
            0, PATCHES,
        )  # fmt: skip
        if direct:
            found = found * self._material_map(rays, "map1")[:, :, None]
        return found

    def sun_pixels(self, view: str, octree: str) -> tuple[np.ndarray, np.ndarray]:
        """C_R-ds and C_F-ds of a view, each (channel, ray, sun)."""
        rays = self._rays(view)
        options = f"rcontrib {SUN} -ff"
        directions = self.effort.pixel_direct
        suns, end = len(self.lit()), f"{self._modifiers()} {octree}.oct < {rays}"
        room = self.matrix(f"{options} -i -ab 1 -ad {directions} {end}", 0, suns)
        facade = self.matrix(f"{options} -ab 0 {end}", 0, suns)
        room = room * self._material_map(rays, "map2")[:, :, None]
        scale = SUN_RADIANCE * SUN_SR
        return room / scale, facade / scale

    def _material_map(self, rays: str, octree: str) -> np.ndarray:
        # Radiance under ambient light of 1/π: reflectance over π, eq. (4) and (5)
        found = self.matrix(
            "rtrace -h- -ff -w- -ab 0 -av .3183099 .3183099 .3183099"
            f" {octree}.oct < {rays}",
            0, 1,
        )  # fmt: skip
        return found[:, :, 0]

    def _modifiers(self) -> str:
        return " ".join(f"-m sun{i}" for i in range(len(self.lit())))

    # ------------------------------ running ------------------------------

    def run(self, command: str) -> str:
        """Run a shell command in the folder and return what it prints."""
        return self._output(command).decode()

    def matrix(self, command: str, run: int, columns: int) -> np.ndarray:
        """Return binary output without header as (channel, row, column)."""
        found = self.cached(command, run=run, columns=columns)
        return found.transpose(2, 0, 1)

    def cached(self, command: str, *, run: int = 0, columns: int = 0) -> np.ndarray:
        """Return output as (row, column, channel); kept where a folder is named."""
        kept = os.environ.get(KEPT)
        text = f"{command} {run} {self.effort} {self._scene_key()}"
        name = hashlib.sha256(text.encode()).hexdigest()[:24]
        path = Path(kept) / f"{name}.npy" if kept else None
        if path is not None and path.exists():
            return np.load(path)
        found = _table(self._output(command), columns)
        if path is not None:
            np.save(path, found)
        return found

    def _scene_key(self) -> str:
        suns = self.folder / "suns.rad"
        return hashlib.sha256(suns.read_bytes() if suns.exists() else b"").hexdigest()

    def _output(self, command: str) -> bytes:
        done = subprocess.run(
            command, shell=True, cwd=self.folder, env=ENVIRONMENT,
            capture_output=True, check=False,
        )  # fmt: skip
        assert done.returncode == 0, f"{command}\n{done.stderr.decode()}"
        return done.stdout


def _table(output: bytes, columns: int) -> np.ndarray:
    # gendaymtx writes a header that tells its size, the others were asked for none
    if columns:
        return np.frombuffer(output, "<f4").reshape(-1, columns, 3)
    head, _, body = output.partition(b"\n\n")
    fields = dict(line.split(b"=", 1) for line in head.splitlines() if b"=" in line)
    rows, steps = int(fields[b"NROWS"]), int(fields[b"NCOLS"])
    return np.frombuffer(body, "<f4").reshape(rows, steps, 3)
