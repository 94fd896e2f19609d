"""Random walks of light between two panes and the slats of a blind, in 3D.

The referee of matrices of a blind behind double glazing: flat slats that reflect
diffusely, and smooth panes, in exact directions and without patches.
"""

import numpy as np

# Slats above and below that a ray may meet, reflections, and the least weight
_REACH, _BOUNCES, _LEAST = 8, 200, 1e-4


def pane_pair(pane):
    """Function of cosines: transmittance and reflectance of two equal smooth panes."""
    cosine = np.linspace(1e-3, 1, 2001)
    one = pane.angular(np.array([500.0]), cosine)
    t, r = one.transmission_front[0], one.reflection_front[0]
    through, back = t * t / (1 - r * r), r + t * t * r / (1 - r * r)
    return lambda c: (np.interp(c, cosine, through), np.interp(c, cosine, back))


def transmitted(direction, panes, slats, *, reflectance, gap, paths=20_000, seed=1):
    """Transmittance of panes and blind for light that travels in a direction.

    Parameters
    ----------
    direction : to the right, up, and into the room; a unit vector
    panes : transmittance and reflectance by cosine, as `pane_pair` returns them
    slats : geometry of flat slats
    gap : distance of the blind from the panes [m]
    """
    rng = np.random.default_rng(seed)
    half = slats.width / 2 * np.array([np.cos(slats.tilt), np.sin(slats.tilt)])
    normal = np.array([-half[1], half[0]]) / (slats.width / 2)
    shift = np.arange(-_REACH, _REACH + 1) * slats.spacing
    way = np.repeat(np.asarray(direction, float)[None], paths, axis=0)
    weight = panes(way[:, 2])[0]
    # Places in the section: into the room, and up; slats have their middles at x = 0
    edge = -half[0] - 1e-9
    place = np.stack([np.full(paths, edge), rng.random(paths) * slats.spacing], 1)
    leaving, total = np.zeros(paths, bool), 0.0
    for _ in range(_BOUNCES):
        along = way[:, [2, 1]]
        away = np.stack(np.broadcast_arrays(0, shift), 1) - place[:, None]
        across = (along[:, 0] * half[1] - along[:, 1] * half[0])[:, None]
        far = (away[..., 0] * half[1] - away[..., 1] * half[0]) / across
        on = (away[..., 0] * along[:, 1:] - away[..., 1] * along[:, :1]) / across
        met = (far > 1e-12) & (np.abs(on) <= 1)
        met[:, _REACH] &= ~leaving
        far = np.where(met, far, np.inf)
        slat, hit = far.argmin(axis=1), met.any(axis=1)

        # Light that passes all slats, into the room or back to the panes
        out = ~hit & (way[:, 2] > 0)
        total += weight[out].sum()
        back = ~hit & ~out
        weight[back] *= panes(-way[back, 2])[1]
        climb = way[back, 1] / -way[back, 2]
        height = place[back, 1] + climb * (place[back, 0] - edge + 2 * gap)
        place[back] = np.stack([np.full(len(height), edge), height % slats.spacing], 1)
        way[back, 2] *= -1

        # Diffuse reflection, on the side that the light came from
        step = far[hit, slat[hit]]
        place[hit] += step[:, None] * along[hit]
        place[hit, 1] -= shift[slat[hit]]
        side = -np.sign(along[hit] @ normal)[:, None] * normal
        u, v = rng.random((2, hit.sum()))
        flat, turn = np.sqrt(u), 2 * np.pi * v
        section = np.sqrt(1 - u)[:, None] * side
        section += (flat * np.cos(turn))[:, None] * half / (slats.width / 2)
        sideways = flat * np.sin(turn)
        way[hit] = np.stack([sideways, section[:, 1], section[:, 0]], 1)
        weight[hit] *= reflectance
        leaving = hit
        keep = ~out & (weight > _LEAST)
        weight, way, place, leaving = (
            weight[keep],
            way[keep],
            place[keep],
            leaving[keep],
        )
        if not len(weight):
            break
    return total / paths
