"""α-opic quantities of CIE S 026:2018, such as melanopic equivalent daylight lux.

An α-opic irradiance is ∫ E(λ) s(λ) dλ with the action spectrum s of a photoreceptor:
melanopsin cells, rods, or one of three kinds of cones. Divided by the α-opic efficacy
of luminous radiation of D65, it is the illuminance of D65 with the same α-opic
irradiance: the equivalent daylight illuminance (EDI).
"""

import numpy as np
from jaxtyping import Float

from clerestory.bands import Bands, weighted_sum
from clerestory.checks import one_of
from clerestory.spectral.band_sets import WEIGHTINGS, efficacy
from clerestory.spectral.functions import MAXIMUM_EFFICACY, integral, spectral_function

# Equivalent melanopic lux (WELL v1) per melanopic equivalent daylight illuminance
EML_PER_EDI = 1 / 0.9063


def daylight_efficacy(quantity: str) -> float:
    """α-opic efficacy of luminous radiation of illuminant D65 [W/lm].

    >>> f"{1000 * daylight_efficacy('melanopic'):.4f} mW/lm"  # CIE S 026, table 4
    '1.3262 mW/lm'
    """
    one_of(quantity, "the quantity", choices=WEIGHTINGS)
    d65 = spectral_function("d65")
    weighted = integral(d65 * spectral_function(WEIGHTINGS[quantity]))
    luminous = MAXIMUM_EFFICACY * integral(d65 * spectral_function("y"))
    return float(weighted / luminous)


def edi_weights(bands: Bands, quantity: str) -> Float[np.ndarray, " band"]:
    """Equivalent daylight illuminance per irradiance in each band [lux/(W/m²)].

    For the quantity "photopic" these are the luminous efficacies of the bands. The
    weights also give the α-opic equivalent daylight luminance from radiance.

    Parameters
    ----------
    quantity : "melanopic", "rhodopic", "s_cone", "m_cone", "l_cone" or "photopic"

    Raises
    ------
    InputError : unknown quantity, or bands from which it cannot be computed
    """
    return efficacy(bands, quantity) / daylight_efficacy(quantity)


def equivalent_daylight_illuminance(
    irradiance: Float[np.ndarray, "*batch"],
    bands: Bands,
    quantity: str = "melanopic",
    *,
    axis: int = 0,
) -> Float[np.ndarray, "..."]:
    """Equivalent daylight (D65) illuminance [lux] from the irradiance in bands.

    Parameters
    ----------
    irradiance : irradiance [W/m²] with the bands along `axis`; or one channel of grey
        light that applies to all bands

    Examples
    --------
    >>> from clerestory.spectral.band_sets import band_set
    >>> white = np.ones(20)  # equal-energy white, 179 lux
    >>> round(float(equivalent_daylight_illuminance(white, band_set("20"))), 1)
    162.1
    """
    return weighted_sum(irradiance, edi_weights(bands, quantity), axis=axis)


def daylight_efficacy_ratio(
    irradiance: Float[np.ndarray, "*batch"],
    bands: Bands,
    quantity: str = "melanopic",
    *,
    axis: int = 0,
) -> Float[np.ndarray, "..."]:
    """α-opic daylight (D65) efficacy ratio: EDI over illuminance; NaN in the dark."""
    edi = equivalent_daylight_illuminance(irradiance, bands, quantity, axis=axis)
    lux = weighted_sum(irradiance, edi_weights(bands, "photopic"), axis=axis)
    return np.asarray(np.divide(edi, lux, out=np.full_like(edi, np.nan), where=lux > 0))
