"""Conversion of luminaires and luminous panels to scenes."""

import numpy as np
from jaxtyping import Float

from clerestory.bands import RGB
from clerestory.checks import not_negative, positive, require
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.formats.photometry.luminaire import Luminaire
from clerestory.formats.photometry.shining import (
    LuminairePattern,
    faces,
    shining_surfaces,
)
from clerestory.scene.materials.emitters import Light
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.surface import area_vector, transformed
from clerestory.scene.transform import Transform

WHITE = (1.0, 1.0, 1.0)


def luminaire_scene(
    luminaire: Luminaire,
    *,
    position: Float[np.ndarray, "3"] | tuple[float, float, float] = (0.0, 0.0, 0.0),
    turn_deg: float = 0.0,
    tilt_deg: float = 0.0,
    dimming: float = 1.0,
    colour: tuple[float, float, float] = WHITE,
    name: str = "luminaire",
) -> Scene:
    """Return the emitting surfaces of a luminaire as a scene, to be added to a room.

    Parameters
    ----------
    luminaire : intensity distribution and luminous shape
    position : centre of the luminous shape [m]
    turn_deg : rotation about the vertical, counter-clockwise as seen from above
    tilt_deg : rotation about the luminaire's x axis, before `turn_deg`
    dimming : fraction of full luminous flux
    colour : colour of the light as RGB; only the ratios are used
    name : name of the material, and prefix of the names of surfaces

    Raises
    ------
    InputError : dimming or colour is negative, or horizontal lamps with tilt-dependent
        flux are tilted

    Examples
    --------
    >>> from clerestory.formats.photometry.luminaire import LuminousShape
    >>> panel = LuminousShape("box", 0.6, 0.6, 0.0)
    >>> angles, table = np.array([0.0, 90.0]), np.array([[1000.0, 0.0]])
    >>> lamp = Luminaire("panel", "C", np.zeros(1), angles, table, panel)
    >>> room = luminaire_scene(lamp, position=(2.0, 3.0, 2.8))
    >>> [surface.name for surface in room.surfaces]
    ['luminaire.d']
    """
    scaled = luminaire.scaled(dimming * _tilt_factor(luminaire, tilt_deg))
    place = _place(np.asarray(position, dtype=float), turn_deg, tilt_deg)
    pattern = LuminairePattern(scaled, faces(scaled), place)
    light = Light(name, _balanced(colour), pattern=pattern)
    parts = shining_surfaces(scaled, material=name, name=name)
    return Scene({name: light}, tuple(transformed(part, place) for part in parts))


def panel_scene(
    vertices: Float[np.ndarray, "vertices 3"],
    *,
    lumens: float,
    colour: tuple[float, float, float] = WHITE,
    name: str = "panel",
) -> Scene:
    """Return a Lambertian panel of uniform luminance as a scene.

    Parameters
    ----------
    vertices : outline [m], counter-clockwise as seen from the emitting front
    lumens : luminous flux [lm]
    colour : colour of the light as RGB; only the ratios are used
    name : name of the material and of the surface

    Raises
    ------
    InputError : the outline has no area, or flux or colour is negative

    Examples
    --------
    >>> corners = np.array([[0.0, 0, 3], [0, 1, 3], [1, 1, 3], [1, 0, 3]])
    >>> ceiling = panel_scene(corners, lumens=np.pi * 179)
    >>> ceiling.materials["panel"].radiance.round(9).tolist()
    [1.0, 1.0, 1.0]
    """
    area = float(np.linalg.norm(area_vector(vertices)))
    positive(area, f'area of the panel "{name}"', unit="m²")
    not_negative(lumens, f'luminous flux of the panel "{name}"', unit="lm")
    radiance = lumens / LUMINOUS_EFFICACY / (np.pi * area)
    light = Light(name, radiance * _balanced(colour))
    return Scene({name: light}, (Polygon(vertices, name, name),))


def _balanced(colour: tuple[float, float, float]) -> Float[np.ndarray, "3"]:
    # Colour scaled to luminance 1
    given = np.asarray(colour, dtype=float)
    level = float(given @ RGB.shares)
    not_negative(given, "a component of the colour")
    positive(level, f"luminance of the colour {colour}")
    return np.asarray(given / level)


def _tilt_factor(luminaire: Luminaire, tilt_deg: float) -> float:
    if luminaire.tilt is None:
        return 1.0
    require(
        luminaire.tilt.geometry == 1 or tilt_deg == 0,
        f'luminaire "{luminaire.name}" has horizontal lamps whose output depends on'
        " the tilt; a tilt of 0 expected",
    )
    return luminaire.tilt.at(tilt_deg)


def _place(
    position: Float[np.ndarray, "3"], turn_deg: float, tilt_deg: float
) -> Transform:
    turn, tilt = np.radians(turn_deg), np.radians(tilt_deg)
    lean, spin = np.eye(4), np.eye(4)
    lean[1:3, 1:3] = [[np.cos(tilt), np.sin(tilt)], [-np.sin(tilt), np.cos(tilt)]]
    spin[:2, :2] = [[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]]
    shift = np.eye(4)
    shift[3, :3] = position
    return Transform(lean @ spin @ shift)
