"""Panes: spectral properties of glass, or of the material of a shade.

Measurements are at normal incidence. The front is surface 1; it faces the sky unless
the pane is `flipped`.
"""

from dataclasses import dataclass, replace
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Mask, PerWavelength, Values
from clerestory.brief_repr import brief
from clerestory.bsdf.scattering_function import Function
from clerestory.checks import not_negative, positive, same_length
from clerestory.errors import located
from clerestory.glazing.angular_dependence import coated, uncoated
from clerestory.glazing.optics import Optics
from clerestory.spectra import check_wavelengths

# Emissivity and conductivity [W/(m K)] of soda-lime glass.
GLASS_EMISSIVITY = 0.84
GLASS_CONDUCTIVITY = 1.0

# Visible range, width of the transitions at both ends, and solar range [nm].
_VISIBLE_NM = (380.0, 780.0)
_STEP_NM = 1e-3
_SOLAR_NM = (300.0, 2500.0)

# Visible fraction of solar energy, as in WINDOW.
VISIBLE_SHARE = 0.49


@final
@dataclass(frozen=True, eq=False)
class Pane:
    """Spectral and thermal properties of a sheet.

    Attributes
    ----------
    name : product name
    wavelength_nm : wavelengths of the spectral data [nm]
    direct : specular transmittances and reflectances over wavelength
    diffuse : diffuse transmittances and reflectances; None for clear sheets
    coated : whether the angular dependence follows the regression for coatings (also
        films and laminates) instead of Fresnel's equations
    thickness : thickness of the sheet [m]
    conductivity : thermal conductivity [W/(m K)]
    emissivity_front, emissivity_back : hemispherical emissivities in the far infrared
    infrared_transmittance : transmittance in the far infrared
    coated_side : "front", "back", "both" or "neither", as stated in the file
    manufacturer, nfrc_id : manufacturer and NFRC number stated in the file
    source : path of the file, for messages

    Raises
    ------
    InputError : arrays of different lengths, or values that are negative or not finite
    """

    name: str
    wavelength_nm: PerWavelength
    direct: Optics
    diffuse: Optics | None = None
    coated: bool = False
    thickness: float = 0.003
    conductivity: float = GLASS_CONDUCTIVITY
    emissivity_front: float = GLASS_EMISSIVITY
    emissivity_back: float = GLASS_EMISSIVITY
    infrared_transmittance: float = 0.0
    coated_side: str = "neither"
    manufacturer: str = ""
    nfrc_id: int | None = None
    source: str | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        with located(file=None, subject=f"pane {self.name!r}"):
            check_wavelengths(self.wavelength_nm)
            for optics in filter(None, (self.direct, self.diffuse)):
                part = np.stack(np.broadcast_arrays(*vars(optics).values()))
                same_length(part[0], self.wavelength_nm, "values", "wavelengths")
                not_negative(part, "a transmittance or reflectance")
            positive(self.thickness, "thickness", unit="m")
            positive(self.conductivity, "thermal conductivity", unit="W/(m K)")

    def at(self, wavelength_nm: Values) -> Optics:
        """Direct plus diffuse transmittances and reflectances at normal incidence."""
        total = self.direct.map(lambda share: self._at(share, wavelength_nm))
        if self.diffuse is None:
            return total
        return total.plus(self.diffuse.map(lambda part: self._at(part, wavelength_nm)))

    def haze(self, wavelength_nm: Values) -> Optics:
        """Diffuse fraction of each transmittance and reflectance; 0 if these are 0."""
        total = self.at(wavelength_nm)
        if self.diffuse is None:
            return total.map(np.zeros_like)
        scattered = self.diffuse.map(lambda share: self._at(share, wavelength_nm))
        return Optics.gather(
            lambda name: (
                scattered.of(name) / np.where(total.of(name) > 0, total.of(name), 1)
            )
        )

    def angular(
        self,
        wavelength_nm: Float[np.ndarray, " wanted"],
        cosine: Float[np.ndarray, " angle"],
    ) -> Optics:
        """Transmittances and reflectances by wavelength and cosine of incidence."""
        course = coated if self.coated else uncoated
        normal = self.at(wavelength_nm).map(lambda share: share[:, None])
        front, back = (
            course(cosine, transmittance=one, reflectance=other)
            for one, other in (
                (normal.transmission_front, normal.reflection_front),
                (normal.transmission_back, normal.reflection_back),
            )
        )
        oblique = Optics(front[0], back[0], front[1], back[1])
        upright = cosine == 1
        return Optics.gather(
            lambda name: np.where(upright, normal.of(name), oblique.of(name))
        )

    def flipped(self) -> "Pane":
        """Return the pane reversed."""
        sides = {"front": "back", "back": "front"}
        return replace(
            self,
            direct=self.direct.swapped(),
            diffuse=None if self.diffuse is None else self.diffuse.swapped(),
            emissivity_front=self.emissivity_back,
            emissivity_back=self.emissivity_front,
            coated_side=sides.get(self.coated_side, self.coated_side),
        )

    def _at(
        self, share: PerWavelength, wavelength_nm: Float[np.ndarray, " wanted"]
    ) -> Float[np.ndarray, " wanted"]:
        return np.asarray(np.interp(wavelength_nm, self.wavelength_nm, share))


def two_band_pane(name: str, *, solar: Optics, visible: Optics) -> Pane:
    """Return a sheet with known solar and visible averages.

    Values at invisible wavelengths follow from the solar average, with 49 % of solar
    energy in the visible range as in WINDOW.
    """
    wavelength = two_band_wavelengths()
    return Pane(name, wavelength, two_bands(visible, solar, is_visible(wavelength)))


def grey_pane(transmittance: float, reflectance: float, *, name: str = "grey") -> Pane:
    """Return a sheet with equal values at all wavelengths and on both sides."""
    shares = Optics.alike(transmittance, reflectance)
    return two_band_pane(name, solar=shares, visible=shares)


def two_bands(visible: Optics, solar: Optics, inside: Mask) -> Optics:
    """Spectral values with the given averages; constant inside the visible range.

    Negative values are set to zero.
    """

    def part(name: Function) -> Values:
        known = visible.of(name)
        rest = (solar.of(name) - VISIBLE_SHARE * known) / (1 - VISIBLE_SHARE)
        return np.where(inside, known, np.maximum(rest, 0))

    return Optics.gather(part)


def two_band_wavelengths() -> Values:
    """Wavelengths at the limits of the solar and the visible range [nm]."""
    low, high = _VISIBLE_NM
    return np.array(
        [_SOLAR_NM[0], low - _STEP_NM, low, high, high + _STEP_NM, _SOLAR_NM[1]]
    )


def is_visible(wavelength_nm: Values) -> Mask:
    """Whether wavelengths are from 380 to 780 nm."""
    low, high = _VISIBLE_NM
    return np.asarray((wavelength_nm >= low) & (wavelength_nm <= high))
