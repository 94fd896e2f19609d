"""Lambertian layers: opal film, fabric without openings."""

from dataclasses import dataclass
from typing import final

import numpy as np

from clerestory.array_types import Values
from clerestory.glazing.layer import MaterialLayer
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import Pane
from clerestory.hemisphere.partition import RingPartition


@final
@dataclass(frozen=True, eq=False)
class Diffuser(MaterialLayer):
    """A Lambertian sheet.

    Attributes
    ----------
    material : transmittances and reflectances at every angle
    """

    material: Pane

    def matrices(self, wavelength_nm: Values, partition: RingPartition) -> Optics:
        """BSDFs [1/sr] over (wavelength, exit, incident)."""
        covered = np.ones(len(partition))
        return scattered_evenly(self.material.at(wavelength_nm), covered)

    def flipped(self) -> "Diffuser":
        """Return the layer turned round."""
        return Diffuser(self.material.flipped())


def scattered_evenly(shares: Optics, covered: Values) -> Optics:
    """BSDFs [1/sr] of a Lambertian material that covers part of the area.

    Parameters
    ----------
    shares : of the material, over wavelength
    covered : covered area fraction, seen from each incident patch
    """
    even = covered / np.pi * np.ones((len(covered), 1))
    return shares.map(lambda share: share[:, None, None] * even)
