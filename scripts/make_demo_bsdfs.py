"""Make the BSDFs of the demo room: a blind behind double glazing, and the glazing.

    python scripts/make_demo_bsdfs.py [FOLDER]

writes venetian_blind.xml and double_pane.xml in about two minutes on one core; the
result is the same in every run.

The window is that of LBNL's FLEXLAB test room: dual pane, visible transmittance 0.64;
inside it a horizontal venetian blind with slats 25.4 mm wide, reflectance 0.733, tilted
to keep the sun out. Paths of light are followed through one period of the blind; the
glazing is a plane that transmits and reflects by Fresnel's equations. A parity test
compares the result with Radiance's genBSDF method.
"""

import math
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.optimize import brentq

from clerestory.bsdf.analytic import glass_properties, thin_pane
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.hemisphere.klems import klems

VISIBLE_TRANSMITTANCE = 0.64  # of the two panes, at normal incidence
INDEX = 1.52
REFLECTANCE = 0.733

# Slats [m]: curved upwards, the outer edge lower than the inner one
WIDTH, SPACING, CAMBER, TILT = 0.0254, 0.021, 0.0018, math.radians(45)
FACETS = 4

# Distances from the blind to the inner pane, and between the panes [m]
AIR_GAP, PANE_GAP = 0.020, 0.0127

SAMPLES = 60_000  # paths per incident patch
DIGITS = 5


def pane_transmissivity() -> float:
    """Transmissivity of each of two equal panes that pass 64 % together."""

    def excess(transmissivity: float) -> float:
        both, _ = glass_properties(
            np.array(1.0), transmissivity=transmissivity, index=INDEX, panes=2
        )
        return float(both) - VISIBLE_TRANSMITTANCE

    return float(brentq(excess, 0.5, 1.0))


def slat_section() -> Float[np.ndarray, "point 2"]:
    """Points (up, into the room) of one slat from its outer to its inner edge [m]."""
    radius = (WIDTH**2 / 4 + CAMBER**2) / (2 * CAMBER)
    half = math.asin(WIDTH / 2 / radius)
    turn = np.linspace(-half, half, FACETS + 1)
    along, above = radius * np.sin(turn), radius * np.cos(turn) - (radius - CAMBER)
    up = along * math.sin(TILT) + above * math.cos(TILT)
    inwards = along * math.cos(TILT) - above * math.sin(TILT)
    return np.stack([up, inwards - inwards.max()], axis=-1)


@dataclass(frozen=True, eq=False)
class Hits:
    """Where paths meet the slats next.

    Attributes
    ----------
    time : path length to the slat over the length of the direction; inf for none
    normal : unit normal (up, into the room) of the facet
    """

    time: Float[np.ndarray, " path"]
    normal: Float[np.ndarray, "path 2"]


def next_hits(
    point: Float[np.ndarray, "path 2"], direction: Float[np.ndarray, "path 2"]
) -> Hits:
    """Meet the slats of this period and of two periods above and below."""
    section = slat_section()
    time = np.full(len(point), np.inf)
    normal = np.zeros_like(point)
    for period in range(-2, 3):
        corners = section + np.array([period * SPACING, 0])
        for start, edge in zip(corners, np.diff(corners, axis=0), strict=False):
            # Solve point + t·direction = start + u·edge
            across = direction @ [edge[1], -edge[0]]
            gap = start - point
            with np.errstate(divide="ignore", invalid="ignore"):
                t = gap @ [edge[1], -edge[0]] / across
                u = (gap[:, 0] * direction[:, 1] - gap[:, 1] * direction[:, 0]) / across
            nearer = (t > 1e-9) & (t < time) & (u >= 0) & (u <= 1)
            time[nearer] = t[nearer]
            normal[nearer] = [-edge[1], edge[0]] / np.hypot(*edge)
    return Hits(time, normal)


def follow_paths(
    direction: Float[np.ndarray, "path 3"], rng: np.random.Generator
) -> tuple[Float[np.ndarray, "path 3"], Bool[np.ndarray, " path"]]:
    """Follow light from behind the glazing until it is in the room or lost.

    Directions are (right, up, into the room).

    Returns
    -------
    the last direction of each path, and whether it reached the room
    """
    count = len(direction)
    outer = float(slat_section()[:, 1].min())
    direction = direction.copy()
    place = np.stack([rng.random(count) * SPACING, np.full(count, outer)], axis=-1)
    arrived = np.zeros(count, dtype=bool)
    alive = np.arange(count)
    while len(alive):
        d, p = direction[alive, 1:], place[alive]
        hits = next_hits(p, d)

        # Find what comes first: a slat, the end of the blind, the end of this period
        with np.errstate(divide="ignore"):
            leave = np.where(d[:, 1] > 0, -p[:, 1], outer - p[:, 1]) / d[:, 1]
            period = SPACING / np.abs(d[:, 0])
        step = np.minimum(np.minimum(hits.time, leave), period)
        p = p + step[:, None] * d
        bounces, leaves = hits.time <= step, (leave <= step) & (hits.time > step)

        arrived[alive[leaves & (d[:, 1] > 0)]] = True
        place[alive] = p
        lost = leaves & (d[:, 1] > 0)
        lost |= _scatter(direction, place, alive, bounces, hits.normal, rng)
        lost |= _return_from_glazing(
            direction, place, alive, leaves & (d[:, 1] < 0), rng
        )
        place[alive, 0] %= SPACING
        alive = alive[~lost]
    return direction, arrived


def _scatter(
    direction: Float[np.ndarray, "path 3"],
    place: Float[np.ndarray, "path 2"],
    alive: Int[np.ndarray, " alive"],
    bounces: Bool[np.ndarray, " alive"],
    normal: Float[np.ndarray, "alive 2"],
    rng: np.random.Generator,
) -> Bool[np.ndarray, " alive"]:
    # Reflect diffusely off the side of the slat that was met, or be absorbed
    paths, n = alive[bounces], normal[bounces]
    n = n * -np.sign(np.sum(n * direction[paths, 1:], axis=1, keepdims=True))
    turn, square = rng.random((2, len(paths)))
    flat, height = np.sqrt(square), np.sqrt(1 - square)
    sideways, along = flat * np.cos(2 * np.pi * turn), flat * np.sin(2 * np.pi * turn)
    tangent = np.stack([-n[:, 1], n[:, 0]], axis=-1)
    direction[paths, 0] = sideways
    direction[paths, 1:] = height[:, None] * n + along[:, None] * tangent
    place[paths] += 1e-9 * n
    lost = bounces.copy()
    lost[bounces] = rng.random(len(paths)) > REFLECTANCE
    return lost


def _return_from_glazing(
    direction: Float[np.ndarray, "path 3"],
    place: Float[np.ndarray, "path 2"],
    alive: Int[np.ndarray, " alive"],
    outwards: Bool[np.ndarray, " alive"],
    rng: np.random.Generator,
) -> Bool[np.ndarray, " alive"]:
    # Reflect off the glazing, or get lost outside
    paths = alive[outwards]
    cosine = -direction[paths, 2]
    _, reflected = glazing_shares(cosine)
    place[paths, 0] += 2 * AIR_GAP * direction[paths, 1] / cosine
    direction[paths, 2] = cosine
    lost = outwards.copy()
    lost[outwards] = rng.random(len(paths)) > reflected
    return lost


def glazing_shares(
    cosine: Float[np.ndarray, " path"],
) -> tuple[Float[np.ndarray, " path"], Float[np.ndarray, " path"]]:
    """Share of the light that both panes transmit and reflect."""
    return glass_properties(
        cosine, transmissivity=pane_transmissivity(), index=INDEX, panes=2
    )


def venetian_blind(samples: int = SAMPLES) -> Bsdf:
    """Return the transmission of the blind behind its glazing, from outside."""
    full = klems("full")
    rng = np.random.default_rng(1)
    share = np.zeros((len(full), len(full)))
    for patch in range(len(full)):
        into = full.sample(np.full(samples, patch), rng.random((samples, 2)))
        weight, _ = glazing_shares(into[:, 2])
        leaving, arrived = follow_paths(into, rng)
        found = full.find(leaving[arrived])
        share[:, patch] = np.bincount(found, weight[arrived], minlength=len(full))
    values = share / samples / full.projected_solid_angles()[:, None]

    # The blind looks the same from left and right: average out the noise
    mirror = full.find(full.centres() * [-1, 1, 1])
    values = (values + values[np.ix_(mirror, mirror)]) / 2
    depth = PANE_GAP + AIR_GAP - float(slat_section()[:, 1].min())
    product = Product(
        name="Venetian blind 25 mm at 45 degrees behind double glazing",
        manufacturer="Clerestory",
        device_type="Venetian Blinds",
        thickness=round(depth, 4),
    )
    part = ScatteringMatrix(values, full, full)
    return Bsdf({("visible", "transmission_front"): part}, product)


def double_pane() -> Bsdf:
    """Return the two panes without the blind, from Fresnel's equations."""
    panes = thin_pane(pane_transmissivity(), klems("full"), index=INDEX, panes=2)
    product = Product(
        name="Double glazing, visible transmittance 0.64",
        manufacturer="Clerestory",
        device_type="Other",
        thickness=PANE_GAP,
    )
    return Bsdf(panes.functions, product)


def main() -> None:
    """Write both files into the folder of the first argument, or beside the demo."""
    default = Path(__file__).parents[1] / "src" / "clerestory" / "demo"
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else default
    comment = "Made by scripts/make_demo_bsdfs.py"
    for name, bsdf in (
        ("double_pane.xml", double_pane()),
        ("venetian_blind.xml", venetian_blind()),
    ):
        write_bsdf(folder / name, bsdf, digits=DIGITS, comment=comment)


if __name__ == "__main__":
    main()
