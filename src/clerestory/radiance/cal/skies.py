"""Sky functions of Radiance's skybright.cal and perezlum.cal.

`skybr` (skybright.cal) is the sky of gensky; `skybright` (perezlum.cal) is the sky of
gendaylit. Both blend sky and ground at the horizon with the weights (z + 1.01)^±10.

References: CIE 22-1973 (clear sky); P. Moon, D. E. Spencer 1942 (overcast sky);
J. Matsuura, T. Iwata 1990 (intermediate sky); R. Perez, R. Seals, J. Michalsky, Solar
Energy 50 (3), 1993. Arguments and horizon blend: Radiance's files.
"""

from collections.abc import Mapping

import numpy as np

from clerestory.array_types import RayVectors
from clerestory.errors import InputError
from clerestory.radiance.cal.library import Native, Surroundings, Values
from clerestory.sky.luminance_distribution import Overcast

_DIRECTION = ("Dx", "Dy", "Dz")

# Sine of the elevation below which the gradation function is constant
_LOWEST = 0.01


def _need(env: Surroundings, count: int, what: str) -> tuple[float, ...]:
    if len(env.arguments) < count:
        raise InputError(
            f"{what} takes {count} real arguments; {len(env.arguments)} given"
        )
    return env.arguments


def _over_ground(height: Values, sky: Values, ground: float) -> Values:
    # Ratio of sky weight to ground weight: (z + 1.01)^20
    share = (height + 1.01) ** 20
    return np.asarray((share * sky + ground) / (share + 1))


def _directions(env: Surroundings) -> RayVectors:
    return np.stack([env.value(name) for name in _DIRECTION], axis=1)


def _gensky(env: Surroundings) -> Values:
    kind, zenith, ground = _need(env, 3, "skybr")[:3]
    height = env.value("Dz")
    match round(kind):
        case 1:
            sky = _clear(env, zenith)
        case 2:
            up = np.array([0.0, 0.0, 1.0])
            sky = zenith * Overcast().relative(_directions(env), sun=up)
        case 3:
            sky = np.full(height.shape, zenith)
        case 4:
            normalisation, *sun = _need(env, 7, "skybr")[3:7]
            relative = _intermediate(_directions(env), np.array(sun))
            sky = zenith * relative / normalisation
        case _:
            raise InputError(f"skybr has no sky type {kind:g}; 1 to 4 expected")
    return _over_ground(height, sky, ground)


def _clear(env: Surroundings, zenith: float) -> Values:
    normalisation, *sun = _need(env, 7, "skybr")[3:7]
    direction = _directions(env)
    cosine = direction @ np.array(sun)
    height = direction[:, 2]
    gamma = np.arccos(np.clip(cosine, -1, 1))
    indicatrix = 0.91 + 10 * np.exp(-3 * gamma) + 0.45 * cosine**2
    above = np.maximum(height, _LOWEST)
    gradation = np.where(height > _LOWEST, 1 - np.exp(-0.32 / above), 1.0)
    return np.asarray(zenith * indicatrix * gradation / normalisation)


def _intermediate(direction: np.ndarray, sun: np.ndarray) -> Values:
    # Defined below the horizon too, where the ground has almost all of the weight
    eta = np.arccos(np.clip(direction[:, 2], -1, 1))
    gamma = np.arccos(np.clip(direction @ sun, -1, 1))
    zenith = np.arccos(np.clip(sun[2], -1, 1))
    level = (1.35 * np.sin(5.631 - 3.59 * eta) + 3.12) * np.sin(4.396 - 2.6 * zenith)
    fall = -0.563 * ((2.629 - eta) * (1.562 - zenith) + 0.812)
    return np.asarray((level + 6.37 - eta) / 2.326 * np.exp(gamma * fall))


def _perez(env: Surroundings) -> Values:
    scale, ground, a, b, c, d, e, *sun = _need(env, 10, "skybright")[:10]
    direction = _directions(env)
    cosine = direction @ np.array(sun)
    gamma = np.arccos(np.clip(cosine, -1, 1))
    above = np.maximum(direction[:, 2], _LOWEST)
    gradation = 1 + a * np.exp(np.maximum(b / above, -700.0))
    indicatrix = 1 + c * np.exp(d * gamma) + e * cosine**2
    return _over_ground(direction[:, 2], scale * gradation * indicatrix, ground)


SKYBRIGHT: Mapping[str, Native] = {"skybr": Native(_gensky, uses=_DIRECTION)}
PEREZLUM: Mapping[str, Native] = {"skybright": Native(_perez, uses=_DIRECTION)}
