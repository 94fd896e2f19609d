"""Layers of a glazing system: four BSDF matrices per wavelength.

A matrix holds BSDF values from incident patches (columns) to exit patches (rows).
Undeviated and specularly reflected light leaves through the exit patch that has the
number of its incident patch, so that matrices of successive layers can be multiplied.

Reference: J. H. Klems, ASHRAE Transactions 100 (1), 1994, 1065–1072 and 1073–1086.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import Self, final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Indices, PerWavelength, Values
from clerestory.bsdf.scattering_function import Function
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane
from clerestory.hemisphere.partition import RingPartition


class Layer(ABC):
    """A pane, blind, fabric or BSDF in a glazing system."""

    @property
    @abstractmethod
    def name(self) -> str:
        """Name shown in reports."""

    @property
    @abstractmethod
    def wavelength_nm(self) -> Values:
        """Wavelengths of the spectral data [nm]."""

    @property
    @abstractmethod
    def thickness(self) -> float:
        """Thickness from the outer to the inner side [m]."""

    @property
    @abstractmethod
    def emissivities(self) -> tuple[float, float]:
        """Far-infrared emissivities of the outer and the inner side, 0…1."""

    @abstractmethod
    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] by wavelength, exit patch and incident patch."""

    @abstractmethod
    def flipped(self) -> "Layer":
        """Return the layer turned about its vertical axis, exchanging its sides."""

    def specular(
        self, wavelength_nm: PerWavelength, cosine: Float[np.ndarray, " angle"]
    ) -> Optics | None:
        """Specular properties by wavelength and angle; None if the layer scatters."""
        return None

    def openness(self, direction: Directions) -> Values:
        """Fraction of the flux in each direction that passes without scattering.

        `direction`: directions of travel; opposite directions for light from the room.
        """
        return np.zeros(len(direction))


@dataclass(frozen=True, eq=False)
class MaterialLayer(Layer):
    """A layer made of one sheet material."""

    material: Pane

    @property
    def wavelength_nm(self) -> PerWavelength:
        """Wavelengths of the material data [nm]."""
        return self.material.wavelength_nm

    @property
    def emissivities(self) -> tuple[float, float]:
        """Far-infrared emissivities of the front and the back of the material."""
        return self.material.emissivity_front, self.material.emissivity_back


@dataclass(frozen=True, eq=False)
class Sheet(MaterialLayer):
    """A flat layer, as thick as its material."""

    @property
    def name(self) -> str:
        """Name of the material."""
        return self.material.name

    @property
    def thickness(self) -> float:
        """Thickness of the material [m]."""
        return self.material.thickness

    def flipped(self) -> Self:
        """Return the layer with its material reversed."""
        return replace(self, material=self.material.flipped())


@final
@dataclass(frozen=True, eq=False)
class Glass(Sheet):
    """A pane of glass in a glazing system.

    Scattered light is distributed uniformly over all patches except that of the
    undeviated direction, as in WINDOW.
    """

    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] by wavelength, exit patch and incident patch."""
        measure = partition.projected_solid_angles()
        total = self.material.angular(wavelength_nm, partition.centres()[:, 2])
        if self.material.diffuse is None:
            return total.map(lambda share: diagonal(share / measure))
        haze = self.material.haze(wavelength_nm).map(lambda share: share[:, None])

        elsewhere = 1 - np.eye(len(measure))

        def scattered(name: Function) -> Float[np.ndarray, "wavelength exit incident"]:
            share, lost = total.of(name), haze.of(name)
            even = share * lost / (np.pi - measure)
            straight = diagonal(share * (1 - lost) / measure)
            return np.asarray(straight + even[:, None, :] * elsewhere)

        return Optics.gather(scattered)

    def specular(
        self, wavelength_nm: PerWavelength, cosine: Float[np.ndarray, " angle"]
    ) -> Optics | None:
        """Specular properties by wavelength and angle; None if the layer scatters."""
        if self.material.diffuse is not None:
            return None
        return self.material.angular(wavelength_nm, cosine)


def diagonal(
    entries: Float[np.ndarray, "wavelength patch"],
) -> Float[np.ndarray, "wavelength patch patch"]:
    """Diagonal matrices with the given entries."""
    count = entries.shape[-1]
    matrices = np.zeros((*entries.shape, count))
    place = np.arange(count)
    matrices[:, place, place] = entries
    return matrices


def mirrored_patches(partition: RingPartition) -> Indices:
    """Patch number of the left–right mirror image of each patch."""
    return partition.find(partition.centres() * [-1, 1, 1])


@final
@dataclass(frozen=True, eq=False)
class Diffuser(Sheet):
    """A Lambertian sheet, with equal properties at all angles of incidence."""

    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] by wavelength, exit patch and incident patch."""
        covered = np.ones(len(partition))
        return lambertian_matrices(self.material.at(wavelength_nm), covered)


def lambertian_matrices(shares: Optics, covered: Values) -> Optics:
    """BSDFs [1/sr] of a Lambertian material that covers part of the area.

    `shares`: material properties by wavelength. `covered`: covered fraction of
    the area, as seen from the direction of each incident patch.
    """
    even = covered / np.pi * np.ones((len(covered), 1))
    return shares.map(lambda share: share[:, None, None] * even)
