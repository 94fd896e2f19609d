"""Quantities of the spectrum of light at eyes: α-opic illuminances, colour, rendering.

The light in bands is reduced to a few products with weights; the quantities follow from
these, and their standard errors from the deviations of the products in each error
component.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.bands import Bands
from clerestory.checks import require
from clerestory.spectral.alpha_opic import edi_weights
from clerestory.spectral.band_sets import WEIGHTINGS, gives
from clerestory.spectral.colour_rendering import colour_rendering, rendering_weights
from clerestory.spectral.colour_temperature import colour_temperature

# Photoreceptors of CIE S 026
PHOTORECEPTORS = tuple(name for name in WEIGHTINGS if name != "photopic")

# Width of the widest band from which colours are computed [nm]
_WIDEST_NM = 25.0

Products = Float[np.ndarray, "product *batch"]
Components = Float[np.ndarray, "component product *batch"]


@dataclass(frozen=True, eq=False)
class SpectralQuantities:
    """Quantities that follow from light in given bands, and the weights of the bands.

    Attributes
    ----------
    bands : bands of the light
    receptors : photoreceptors whose equivalent daylight illuminance the bands give
    coloured : whether the bands are narrow enough for colours

    Examples
    --------
    >>> from clerestory.spectral.band_sets import band_set
    >>> two = SpectralQuantities.of(band_set("melanopic+photopic"))
    >>> two.receptors, two.coloured, two.weights().shape
    (('melanopic',), False, (1, 2))
    """

    bands: Bands
    receptors: tuple[str, ...]
    coloured: bool

    @classmethod
    def of(cls, bands: Bands) -> "SpectralQuantities":
        """Return the quantities that bands give.

        Raises
        ------
        InputError : the bands give no α-opic quantity
        """
        receptors = tuple(name for name in PHOTORECEPTORS if gives(bands, name))
        require(
            receptors,
            f"the bands are {bands}, which give no spectrum; wavelength intervals, or"
            " weighting functions such as melanopic+photopic, expected",
        )
        limits = np.array(bands.limits_nm or [(0.0, np.inf)])
        narrow = np.diff(limits, axis=1).max() <= _WIDEST_NM
        return cls(bands, receptors, bool(narrow))

    def weights(self) -> Float[np.ndarray, "product band"]:
        """Weights of the bands in each product."""
        rows = [edi_weights(self.bands, name) for name in self.receptors]
        rows += [*rendering_weights(self.bands)] if self.coloured else []
        return np.stack(rows)

    def values(self, products: Products) -> Mapping[str, Float[np.ndarray, "..."]]:
        """Return `edi` over (photoreceptor, …), and quantities of colour by name.

        `colour_temperature` [K] and `duv` are NaN where they are not defined, and the
        colour rendering indices `colour_rendering` (Ra) and `colour_rendering_red` (R9)
        there too.
        """
        count = len(self.receptors)
        found: dict[str, np.ndarray] = {"edi": np.asarray(products[:count])}
        if self.coloured:
            colour = colour_temperature(products[count : count + 3])
            rendering = colour_rendering(products[count:])
            found |= {
                "colour_temperature": colour.kelvin,
                "duv": colour.duv,
                "colour_rendering": rendering.general,
                "colour_rendering_red": rendering.red,
            }
        return found

    def errors(
        self, products: Products, components: Components
    ) -> Mapping[str, Float[np.ndarray, "..."]]:
        """Return the standard error of each quantity, from components of the products.

        A component that would make the light impossible is left out.
        """
        return propagated(self.values, products, components)


def propagated(
    function: Callable[[Products], Mapping[str, np.ndarray]],
    products: Products,
    components: Components,
) -> Mapping[str, Float[np.ndarray, "..."]]:
    """Standard errors of functions of products with independent error components.

    >>> def square(x):
    ...     return {"square": x[0] ** 2}
    >>> propagated(square, np.array([[10.0]]), np.array([[[0.3]], [[0.4]]]))["square"]
    array([10.])
    """
    total: dict[str, np.ndarray] = {}
    for own in components:
        above, below = function(products + own), function(products - own)
        for name, values in above.items():
            change = np.nan_to_num((values - below[name]) / 2)
            total[name] = total.get(name, 0) + np.square(change)
    found = {name: np.sqrt(square) for name, square in total.items()}
    mean = function(products)
    return {
        name: np.where(np.isnan(values), np.nan, found.get(name, np.zeros(1)))
        for name, values in mean.items()
    }
