"""Systems in the window of the room, as geometry and as unit cells of their BSDFs.

A façade has one part across the whole window, or one above the other. The truth is
traced through the geometry; the methods see the BSDF of the unit cell.
"""

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from clerestory.bsdfgen.extrusion import extruded
from clerestory.bsdfgen.film_geometry import mirrored_channels, prismatic
from clerestory.bsdfgen.shading_system import SampleArea, System
from clerestory.bsdfgen.venetian_geometry import microlouvre, venetian
from clerestory.scene.model import Dielectric, Glass, Metal, Polygon, Scene
from clerestory.scene.window import Window
from truth.setting import HEAD, PLANE, SILL, WIDTH, pane

# Lower edge of the films of the field test, which fill the upper 0.6 m of the window
CLERESTORY = HEAD - 0.6


@dataclass(frozen=True, eq=False)
class Part:
    """A system between two heights of the window.

    Attributes
    ----------
    name : of the file of its BSDF
    cell : from which its BSDF is made
    across : function of the size in height that returns its geometry, as wide as the
        window, in coordinates of genBSDF
    low, high : heights of its edges [m]
    peak : whether sun passes it straight
    clear : whether it is a film, through which no shadow ray finds the sun
    """

    name: str
    cell: System
    across: Callable[[float], Scene]
    low: float = SILL
    high: float = HEAD
    peak: bool = True
    clear: bool = False

    def window(self) -> Window:
        """Return its part of the window."""
        return pane(f"from {self.low:.2f} m", self.low, self.high)

    def geometry(self) -> Scene:
        """Return its geometry in the frame of the room, inner side in the window."""
        scene = self.across(self.high - self.low)
        low, high = scene.bounds()
        middle = (low + high) / 2
        moved = []
        for surface in scene.surfaces:
            x, y, z = surface.vertices.T
            vertices = np.stack(
                [
                    WIDTH / 2 - (x - middle[0]),
                    PLANE + (z - high[2]),
                    (self.low + self.high) / 2 + (y - middle[1]),
                ],
                axis=-1,
            )
            moved.append(replace(surface, vertices=vertices))
        return Scene(scene.materials, tuple(moved))


@dataclass(frozen=True, eq=False)
class Kind:
    """A façade to compare by, with its name for the tables."""

    name: str
    parts: tuple[Part, ...]

    @property
    def clear(self) -> Part | None:
        """The film, if there is one."""
        return next((part for part in self.parts if part.clear), None)

    def geometry(self) -> Scene:
        """Return the geometry of all parts."""
        total = Scene({}, ())
        for number, part in enumerate(self.parts):
            total += _renamed(part.geometry(), number)
        return total


def kinds() -> dict[str, Kind]:
    """Return the systems of `five_phase_truth.py` by a short name."""
    wide = {"slat_width": 0.08, "spacing": 0.072}
    return {
        "flat": _whole("venetian blind, 0°", _blind("flat", **wide, reflectance=0.48)),
        "tilted": _whole(
            "venetian blind, 45°",
            _blind("tilted", **wide, reflectance=0.48, tilt_deg=45),
        ),
        "mirror": _whole("specular blind, 0°", _polished(_blind("mirror", **wide))),
        "double": _whole("glass double façade with blind, 30°", _double_facade()),
        "louvre": _whole("microlouvre, 40° cut-off", _louvre()),
        "film": prismatic_film(),
    }


def prismatic_film(pitch: float = 2e-3) -> Kind:
    """Return the film, with prisms of another size if wanted [m]."""
    return _whole("prismatic film, 60° and 75°", _prisms(pitch))


def field_kinds() -> dict[str, Kind]:
    """Return façades like those of the field test, by their names in its tables."""
    slats = _blind(
        "narrow", slat_width=0.0254, spacing=0.02, tilt_deg=20, reflectance=0.733
    )
    below = replace(slats, high=CLERESTORY)
    return {
        "DL-L1": Kind("DL-L1", (replace(_channels(), low=CLERESTORY), below)),
        "DL-L2": Kind("DL-L2", (replace(_prisms(), low=CLERESTORY), below)),
        "S-L": _whole("S-L", _louvre()),
        "Ref VB": _whole("Ref VB", slats),
    }


def _whole(name: str, part: Part) -> Kind:
    return Kind(name, (part,))


def _renamed(scene: Scene, number: int) -> Scene:
    # Parts may have materials of one name
    names = {name: f"{name} {number}" for name in scene.materials}
    materials = {
        names[name]: replace(material, name=names[name])
        for name, material in scene.materials.items()
    }
    surfaces = tuple(replace(s, material=names[s.material]) for s in scene.surfaces)
    return Scene(materials, surfaces)


def _blind(name: str, **shape: float) -> Part:
    def across(height: float) -> Scene:
        slats = round(height / shape["spacing"])
        return venetian(**shape, slats=slats, length=WIDTH).scene

    return Part(name, venetian(**shape), across)


def _polished(blind: Part) -> Part:
    # Slats of polished aluminium
    metal = Metal("upper", np.full(3, 0.8), specularity=0.9, roughness=0.0)

    def polish(scene: Scene) -> Scene:
        return Scene({"upper": metal}, scene.surfaces)

    cell = replace(blind.cell, scene=polish(blind.cell.scene))
    return replace(blind, cell=cell, across=lambda height: polish(blind.across(height)))


def _louvre() -> Part:
    # Bars of a microlouvre of 40° cut-off: `microlouvre` is its unit cell
    depth, thick = 1.25e-3, 0.22e-3
    shape = {"slat_width": depth, "thickness": thick, "reflectance": 0.1}
    bars = _blind("louvre", **shape, spacing=thick + depth * np.tan(np.radians(40.0)))
    cell = microlouvre(depth=depth, thickness=thick, cutoff_deg=40.0, reflectance=0.1)
    return replace(bars, cell=cell)


# Distance of the panes of the double façade, and size of the slats between them [m]
_CAVITY, _SLAT, _SPACING, _TILT = 0.14, 0.05, 0.045, 30.0


def _double_facade() -> Part:
    # The unit cell is about eight times as wide and high as it is deep
    count = 25
    side = count * _SPACING
    cell = System(
        _cavity(count, side, beyond=0.01),
        SampleArea(np.array([[0, 0, -_CAVITY], [side, side, 0]]), periodic=True),
    )
    whole = partial(_cavity, length=WIDTH, beyond=0.0)
    return Part("double", cell, lambda height: whole(round(height / _SPACING)))


def _cavity(slats: int, length: float, beyond: float) -> Scene:
    # Panes and slats that extend by a share of their length beyond each end
    ends = -beyond * length, (1 + beyond) * length
    high = slats * _SPACING
    blind = venetian(
        slat_width=_SLAT, spacing=_SPACING, tilt_deg=_TILT, reflectance=0.6,
        slats=slats, length=length,
    ).scene  # fmt: skip
    shift = -_CAVITY / 2 - blind.bounds().mean(axis=0)[2]
    surfaces = []
    for slat in blind.surfaces:
        x, y, z = slat.vertices.T
        x = ends[0] + x / length * (ends[1] - ends[0])
        surfaces.append(replace(slat, vertices=np.stack([x, y, z + shift], axis=1)))
    for number, depth in enumerate((-_CAVITY, 0.0)):
        section = np.array([(-beyond * high, depth), ((1 + beyond) * high, depth)])
        name = f"pane{number}"
        surfaces += extruded(section, ends=ends, material="glass", name=name)
    glass = Glass("glass", np.full(3, 0.96))
    return Scene(blind.materials | {"glass": glass}, tuple(surfaces))


# Prisms and mirrors larger than real ones deflect light alike and cost fewer polygons.
# Base of the prisms relative to their pitch; pitch, thickness and depth of mirrors [m]
_PRISMS = {"upper_angle_deg": 60.0, "lower_angle_deg": 75.0}
_BASE = 0.25
_MIRRORS = {"pitch": 2.65e-3, "thickness": 5e-3, "mirror_depth": 4e-3}


def _prisms(pitch: float = 2e-3) -> Part:
    def across(size: float) -> Scene:
        up, down = (1 / np.tan(np.radians(angle)) for angle in _PRISMS.values())
        height, base = pitch / (up + down), _BASE * pitch
        teeth = [
            (number * pitch + y, z)
            for number in range(round(size / pitch) - 1, -1, -1)
            for y, z in ((height * down, -base - height), (0.0, -base))
        ]
        saw = np.array([(size, -base), *teeth])
        film = Dielectric("film", np.ones(3), 1.49)
        surfaces = [*_strips(saw, "film", "prism"), *_sheet(size, 0.0, "sheet")]
        return Scene({"film": film}, tuple(surfaces))

    return Part("prisms", prismatic(**_PRISMS), across, peak=False, clear=True)


def _channels() -> Part:
    # Most light is reflected once at profile angles from 45° to 65°
    mirror = Metal("mirror", np.full(3, 0.9), 1.0, 0.0)

    def across(size: float) -> Scene:
        pitch, thickness, depth = _MIRRORS.values()
        surfaces = [*_sheet(size, 0.0, "sheet0"), *_sheet(size, -thickness, "sheet1")]
        for number in range(round(size / pitch)):
            y = (number + 0.5) * pitch
            inner, outer = (depth - thickness) / 2, (-depth - thickness) / 2
            line = np.array([(y, inner), (y, outer)])
            surfaces += _strips(line, "mirror", f"mirror{number}")
        film = Dielectric("film", np.ones(3), 1.49)
        return Scene({"film": film, "mirror": mirror}, tuple(surfaces))

    cell = mirrored_channels(**_MIRRORS, reflectance=0.9)
    return Part("channels", cell, across, peak=True, clear=True)


def _sheet(size: float, depth: float, name: str) -> list[Polygon]:
    # Face of a film; its normal points away from the film
    face = np.array([(0.0, depth), (size, depth)])
    return _strips(face if depth == 0 else face[::-1], "film", name)


def _strips(section: np.ndarray, material: str, name: str) -> list[Polygon]:
    return list(extruded(section, ends=(0, WIDTH), material=material, name=name))
