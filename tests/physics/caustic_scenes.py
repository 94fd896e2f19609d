"""Sunlight refracted by a prism and a ball, and reflected by a ball: closed forms."""

import numpy as np
from physics_scenes import quad

from clerestory.scene.model import (
    Dielectric,
    DistantSource,
    Glow,
    Metal,
    Plastic,
    Scene,
    Sphere,
)
from clerestory.scene.view import View

SUN_DEG = 0.533
INDEX = 1.5
GLASS = Dielectric("glass", np.ones(3), INDEX)
BLACK = Plastic("black", np.zeros(3))

# Prism: upper face horizontal at a height [m], lower face sloping upwards to the east
HEIGHT, HALF, THICK, SLOPE_DEG = 2.0, 0.2, 0.3, 15.0
PRISM_SUN = np.array([np.sin(np.radians(20)), 0.0, np.cos(np.radians(20))])

# Ball: radius and height of its centre above the floor, radius around its focus [m]
RADIUS, CENTRE, FOCUS = 0.05, 0.08, 0.02


def lit(surfaces, direction, *materials):
    """A scene with a sun of unit irradiance across its beam."""
    solid = 2 * np.pi * (1 - np.cos(np.radians(SUN_DEG / 2)))
    shine = Glow("sun", np.full(3, 1 / solid), 0.0)
    named = {each.name: each for each in (shine, BLACK, *materials)}
    return Scene(named, surfaces, (DistantSource(direction, SUN_DEG, "sun"),))


def refracted(direction, normal, ratio):
    """Direction behind an interface, and the transmittance, by Snell and Fresnel.

    `normal` points against `direction`; `ratio` is the index before over that behind.
    """
    cosine = -direction @ normal
    square = 1 - ratio**2 * (1 - cosine**2)
    if square <= 0:
        return None, 0.0
    inner = np.sqrt(square)
    across = (ratio * cosine - inner) / (ratio * cosine + inner)
    along = (cosine - ratio * inner) / (cosine + ratio * inner)
    bent = ratio * direction + (ratio * cosine - inner) * normal
    return bent, 1 - (across**2 + along**2) / 2


def prism():
    """A prism in a black ceiling with a hole, lit by the sun."""
    x, z, wide, far = HALF, HEIGHT, 2 * HALF, 20.0
    low = z - THICK - wide * np.tan(np.radians(SLOPE_DEG))
    high = z - THICK + wide * np.tan(np.radians(SLOPE_DEG))
    top = np.array(
        [[-wide, -wide, z], [wide, -wide, z], [wide, wide, z], [-wide, wide, z]]
    )
    below = top * [1, 1, 0] + np.array([[0, 0, h] for h in (low, high, high, low)])
    surfaces = [
        quad((-x, -x, z), (x, -x, z), (x, x, z), (-x, x, z), material="glass"),
        quad(*below[[0, 3, 2, 1]], material="glass"),
    ]
    for one, other in ((0, 1), (1, 2), (2, 3), (3, 0)):
        sides = top[one], below[one], below[other], top[other]
        surfaces.append(quad(*sides, material="black"))
    for sign in (1, -1):
        surfaces += [
            quad(
                (sign * x, -far, z), (sign * far, -far, z),
                (sign * far, far, z), (sign * x, far, z), material="black",
            ),
            quad(
                (-x, sign * x, z), (x, sign * x, z),
                (x, sign * far, z), (-x, sign * far, z), material="black",
            ),
        ]  # fmt: skip
    return lit(tuple(surfaces), PRISM_SUN, GLASS)


def prism_light():
    """Corners of the sunlit patch on the floor, and its irradiance."""
    up = np.array([0.0, 0, 1])
    slope = np.radians(SLOPE_DEG)
    below = np.array([-np.sin(slope), 0, np.cos(slope)])
    inside, first = refracted(-PRISM_SUN, up, 1 / INDEX)
    leaving, second = refracted(inside, below, INDEX)
    # Flux per area is kept along the beam; each face changes the beam's cross-section
    across = first * (PRISM_SUN @ up) / -(inside @ up)
    across *= second * (inside @ below) / (leaving @ below)
    corners = []
    for x in (-HALF, HALF):
        for y in (-HALF, HALF):
            # From the upper face to the plane of the lower face, then to the floor
            point = np.array([x, y, HEIGHT])
            middle = np.array([0, 0, HEIGHT - THICK])
            point = point + inside * ((middle - point) @ below) / (inside @ below)
            corners.append(point - leaving * point[2] / leaving[2])
    return np.array(corners), across * -leaving[2]


def ball():
    """A glass ball above a black floor, with the sun at the zenith."""
    floor = quad((-9, -9, 0), (9, -9, 0), (9, 9, 0), (-9, 9, 0), material="black")
    sphere = Sphere(np.array([0.0, 0, CENTRE]), RADIUS, False, "glass")
    return lit((floor, sphere), np.array([0.0, 0, 1]), GLASS)


def ball_landings(count=200_000):
    """Radii at which rays through the ball reach the floor, and their fluxes."""
    impact = RADIUS * (np.arange(count) + 0.5) / count
    flux = 2 * np.pi * impact * RADIUS / count
    incidence = np.arcsin(impact / RADIUS)
    inner = np.arcsin(impact / RADIUS / INDEX)
    across = np.sin(incidence - inner) / np.sin(incidence + inner)
    along = np.tan(incidence - inner) / np.tan(incidence + inner)
    radii, fluxes = [], []
    for reflections in range(8):
        # Angle of the exit point about the centre, and of the direction, from the sun
        turned = (np.pi - 2 * inner) * (reflections + 1)
        exit_angle = incidence + turned
        heading = exit_angle + incidence
        x, z = RADIUS * np.sin(exit_angle), CENTRE + RADIUS * np.cos(exit_angle)
        sideways, upwards = np.sin(heading), np.cos(heading)
        lands = upwards < -1e-6
        radius = np.abs(x - sideways * z / np.where(lands, upwards, -1))
        # Polarisation is neglected, as in Radiance: the mean reflectance applies
        mean = (across**2 + along**2) / 2
        share = (1 - mean) ** 2 * mean**reflections
        radii.append(radius[lands])
        fluxes.append((flux * share)[lands])
    return np.concatenate(radii), np.concatenate(fluxes)


def focus_view():
    """A view of the floor around the ball's focus."""
    up, north = np.array([0.0, 0, 1]), np.array([0.0, 1, 0])
    return View("parallel", 0.004 * up, -up, north, 2 * FOCUS, 2 * FOCUS)


def focus_shares(pixels, part=16):
    """Share of each pixel of the view that lies within the circle of radius FOCUS."""
    place = (np.arange(pixels * part) + 0.5) / (pixels * part) * 2 - 1
    inside = np.hypot(*np.meshgrid(place, place)) < 1
    return inside.reshape(pixels, part, pixels, part).mean(axis=(1, 3))


def mirror_ball():
    """A ball of polished metal, the sun in the south-east; see `mirror_light`."""
    metal = Metal("metal", np.full(3, 0.8), specularity=1.0)
    sphere = Sphere(np.array([0.0, 0, 0]), 0.3, False, "metal")
    return lit((sphere,), np.array([0.6, -0.8, 0.0]), metal)


def mirror_light(distance, incidence_deg):
    """A sensor in the light that the ball reflects: place, normal and irradiance.

    A beam of light that a sphere reflects at an angle of incidence has the focal
    lengths R/2·cos and R/2/cos.
    """
    sun = np.array([0.6, -0.8, 0.0])
    side = np.array([0.8, 0.6, 0.0])
    angle = np.radians(incidence_deg)
    normal = np.cos(angle) * sun + np.sin(angle) * side
    leaving = 2 * (sun @ normal) * normal - sun
    place = 0.3 * normal + distance * leaving
    spread = (1 + 2 * distance / (0.3 * np.cos(angle))) * (
        1 + 2 * distance * np.cos(angle) / 0.3
    )
    return place, -leaving, 0.8 / spread
