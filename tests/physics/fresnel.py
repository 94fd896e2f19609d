"""Fresnel's formulas of a pane, as a reference for tests."""

import numpy as np


def glazed(pane, cosine):
    """Reflectance and transmittance of a pane at an angle, by Fresnel's formulas."""
    tau, index = pane.transmissivity, pane.index
    inner = np.sqrt(1 - (1 - cosine**2) / index**2)
    reflected, transmitted = np.zeros(3), np.zeros(3)
    for amplitude in (
        (cosine - index * inner) / (cosine + index * inner),
        (index * cosine - inner) / (index * cosine + inner),
    ):
        r, a = amplitude**2, tau ** (1 / inner)
        passed = (1 - r) ** 2 * a / (1 - (r * a) ** 2)
        transmitted += passed / 2
        reflected += (r + r * a * passed) / 2
    return reflected, transmitted
