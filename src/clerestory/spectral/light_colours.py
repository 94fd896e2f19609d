"""Colour of light in spectral bands, relative to white light of the same luminance."""

import numpy as np
from jaxtyping import Float

from clerestory.bands import Bands
from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.spectral.band_sets import light_in_bands
from clerestory.spectral.functions import MAXIMUM_EFFICACY, STEP_NM, spectral_function


def light_colour(
    power: Float[np.ndarray, " wavelength *batch"], bands: Bands
) -> Float[np.ndarray, " band *batch"]:
    """Factor in each band on white light of the same luminance.

    Parameters
    ----------
    power : spectral power at `WAVELENGTH_NM`, in any unit

    Examples
    --------
    >>> from clerestory.spectral.band_sets import band_set
    >>> light_colour(np.ones(401), band_set("melanopic+photopic")).round(9).tolist()
    [1.0, 1.0]
    """
    visible = STEP_NM * spectral_function("y")
    lumen = MAXIMUM_EFFICACY * np.tensordot(visible, power, axes=1)
    light = light_in_bands(LUMINOUS_EFFICACY * power / lumen, bands)
    if bands.efficacy is None:
        return light
    # Mean values in broad bands change the luminance
    return light * LUMINOUS_EFFICACY / np.tensordot(bands.weights, light, axes=1)
