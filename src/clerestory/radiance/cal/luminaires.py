"""Functions of Radiance's source.cal for luminaires from IES files.

Photometric angles [deg] of the emission direction −D: θ is measured from the nadir
(−z), φ from +x towards +y. The correction functions divide the radiant intensity by the
projected area of the luminaire, which gives the radiance.
"""

from collections.abc import Callable, Mapping

import numpy as np

from clerestory.errors import InputError
from clerestory.radiance.cal.library import Native, Surroundings, Values

_DIRECTION = ("Dx", "Dy", "Dz")


def _angle(compute: Callable[[Values, Values, Values], Values]) -> Native:
    # A photometric angle [deg]
    def of_ray(env: Surroundings) -> Values:
        dx, dy, dz = (env.value(name) for name in _DIRECTION)
        return np.asarray(np.degrees(compute(dx, dy, dz)))

    return Native(of_ray, uses=_DIRECTION)


def _azimuth(dx: Values, dy: Values, _: Values) -> Values:
    return np.asarray(np.mod(np.arctan2(-dy, -dx), 2 * np.pi))


def _folded(period: float) -> Callable[[Values, Values, Values], Values]:
    # Azimuth reflected into 0…period, for symmetric luminaires
    def compute(dx: Values, dy: Values, dz: Values) -> Values:
        turn = np.mod(_azimuth(dx, dy, dz), 2 * period)
        return np.asarray(np.minimum(turn, 2 * period - turn))

    return compute


def _sizes(env: Surroundings, count: int, what: str) -> tuple[float, ...]:
    given = env.arguments
    if len(given) < count:
        raise InputError(f"{what} takes {count} real arguments; {len(given)} given")
    return given[:count]


def _multiplied(env: Surroundings, value: Values) -> Values:
    return env.arguments[0] * value if env.arguments else value


def _flat(env: Surroundings, value: Values) -> Values:
    cosine = env.value("Rdot")
    env.fault(cosine == 0)
    return _multiplied(env, value) / np.where(cosine == 0, 1.0, cosine)


def _box(env: Surroundings, value: Values) -> Values:
    multiplier, x, y, z = _sizes(env, 4, "boxcorr")
    dx, dy, dz = (np.abs(env.value(name)) for name in _DIRECTION)
    return np.asarray(multiplier * value / (dx * y * z + dy * x * z + dz * x * y))


def _cylinder(env: Surroundings, value: Values) -> Values:
    multiplier, diameter, height = _sizes(env, 3, "cylcorr")
    up = np.clip(np.abs(env.value("Dz")), 0, 1)
    side = diameter * height * np.sqrt(1 - up**2)
    return np.asarray(multiplier * value / (side + np.pi / 4 * diameter**2 * up))


SOURCE: Mapping[str, Native] = {
    "src_theta": _angle(lambda dx, dy, dz: np.arccos(np.clip(dz, -1, 1))),
    "src_phi": _angle(_azimuth),
    "src_phi2": _angle(_folded(np.pi)),
    "src_phi4": _angle(_folded(np.pi / 2)),
    "srcB_vert": _angle(lambda dx, dy, dz: np.arctan2(-dx, dz)),
    "srcB_vert2": _angle(lambda dx, dy, dz: np.abs(np.arctan2(-dx, dz))),
    "srcB_horiz": _angle(lambda dx, dy, dz: np.arctan2(dy, dz)),
    "srcB_horiz2": _angle(lambda dx, dy, dz: np.abs(np.arctan2(dy, dz))),
    "corr": Native(_multiplied, 1),
    "flatcorr": Native(_flat, 1, ("Rdot",)),
    "boxcorr": Native(_box, 1, _DIRECTION),
    "cylcorr": Native(_cylinder, 1, _DIRECTION),
}
