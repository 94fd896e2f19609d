"""Reader of products of the International Glazing and Shading Database (IGSDB).

Version 1 of the JSON format has "measured_data" and "spectral_data" (or "composition"
for shades made of a material and a geometry); version 2 has "physical_properties".
Lengths are in millimetres, wavelengths in micrometres.

Format: LBNL, https://igsdb.lbl.gov; the same files as pywincalc reads.
"""

from pathlib import Path
from typing import Any

import numpy as np
from pydantic import AliasChoices, AliasPath, Field, model_validator

from clerestory.checks import require
from clerestory.documents import Item
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import GLASS_CONDUCTIVITY, GLASS_EMISSIVITY, Pane

# Product types with the angular dependence of coated glass, as in WINDOW.
_COATED = {"coated", "coated-glass", "applied-film", "applied film", "laminate", "film"}
_COATED |= {"electrochromic", "thermochromic", "chromogenic"}

_MILLIMETRE, _MICROMETRE_NM = 1e-3, 1e3

_TABLE_2 = ("physical_properties", "optical_properties", "optical_data", "angle_blocks")


def _either(default: object, *names: str | AliasPath) -> Any:
    # Field with several possible names; the first name that is present counts
    return Field(default, validation_alias=AliasChoices(*names))


class _Shares(Item):
    tf: float
    tb: float
    rf: float
    rb: float

    def values(self) -> tuple[float, ...]:
        return self.tf, self.tb, self.rf, self.rb


_NONE = _Shares(tf=0.0, tb=0.0, rf=0.0, rb=0.0)


class _Row1(Item):
    wavelength: float
    T: float
    Rf: float
    Rb: float

    def values(self) -> tuple[float, ...]:
        return self.wavelength, self.T, self.T, self.Rf, self.Rb, 0.0, 0.0, 0.0, 0.0


class _Row2(Item):
    w: float
    specular: _Shares = _NONE
    diffuse: _Shares = _NONE

    def values(self) -> tuple[float, ...]:
        return self.w, *self.specular.values(), *self.diffuse.values()


class _Physical(Item):
    # In version 2, names of assumed (not measured) values start with "predefined"
    thickness: float = 3.0
    conductivity: float = GLASS_CONDUCTIVITY
    emissivity_front: float = _either(
        GLASS_EMISSIVITY, "emissivity_front", "predefined_emissivity_front"
    )
    emissivity_back: float = _either(
        GLASS_EMISSIVITY, "emissivity_back", "predefined_emissivity_back"
    )
    tir_front: float = _either(0.0, "tir_front", "predefined_tir_front")


class Product(Item):
    """A product of the IGSDB: glass, or a shade with material and geometry."""

    name: str = ""
    kind: str = _either("", "subtype", "type")
    coated_side: str = ""
    manufacturer: str = _either("", "manufacturer_name", "manufacturer")
    nfrc_id: object = None
    physical: _Physical = _either(_Physical(), "physical_properties", "measured_data")
    rows_1: tuple[_Row1, ...] = _either(
        (), AliasPath("spectral_data", "spectral_data"), "spectral_data"
    )
    rows_2: tuple[_Row2, ...] = _either((), AliasPath(*_TABLE_2, 0, "wavelength_data"))
    material: "Product | None" = _either(
        None, AliasPath("composition", 0, "child_product")
    )
    geometry: dict[str, Any] | None = _either(
        None, AliasPath("composition", 0, "extra_data", "geometry")
    )

    @model_validator(mode="before")
    @classmethod
    def _only(cls, value: Any) -> Any:
        # Some files are lists of one product
        return value[0] if isinstance(value, list) and len(value) == 1 else value

    def pane(self, path: str | Path) -> Pane:
        """Return the glass pane, or the material of the shade."""
        if self.material is not None:
            return self.material.pane(path)
        rows = self.rows_2 or self.rows_1
        require(rows, f"{self.name!r} has no spectral data; T, Rf, Rb expected")
        table = np.array([row.values() for row in rows])
        table = table[np.argsort(table[:, 0], kind="stable")]
        diffuse, side = Optics(*table[:, 5:].T.copy()), self.coated_side.lower()
        physical = self.physical
        return Pane(
            name=self.name or Path(path).stem,
            wavelength_nm=table[:, 0] * _MICROMETRE_NM,
            direct=Optics(*table[:, 1:5].T.copy()),
            diffuse=diffuse if np.any(table[:, 5:] > 0) else None,
            coated=self.kind.lower() in _COATED,
            thickness=physical.thickness * _MILLIMETRE,
            conductivity=physical.conductivity,
            emissivity_front=physical.emissivity_front,
            emissivity_back=physical.emissivity_back,
            infrared_transmittance=physical.tir_front,
            coated_side=side if side in ("front", "back", "both") else "neither",
            manufacturer=self.manufacturer,
            nfrc_id=self.nfrc_id if isinstance(self.nfrc_id, int) else None,
            source=str(path),
        )
