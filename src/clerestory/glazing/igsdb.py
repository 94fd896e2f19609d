"""Reader of products of the International Glazing and Shading Database (IGSDB).

Version 1 of the JSON format has "measured_data" and "spectral_data" (or "composition"
for shades made of a material and a geometry); version 2 has "physical_properties".
Lengths are in millimetres, wavelengths in micrometres.

Format: LBNL, https://igsdb.lbl.gov; the same files as pywincalc reads.
"""

import math
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from clerestory.errors import ClerestoryWarning, InputError
from clerestory.files import read_json
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import GLASS_CONDUCTIVITY, GLASS_EMISSIVITY, Pane

# Product types with the angular dependence of coated glass, as in WINDOW.
_COATED = {"coated", "coated-glass", "applied-film", "applied film", "laminate", "film"}
_COATED |= {"electrochromic", "thermochromic", "chromogenic"}

_MILLIMETRE, _MICROMETRE_NM = 1e-3, 1e3


def read_igsdb(path: str | Path) -> Pane:
    """Return the pane, or the shade material, in a JSON file of version 1 or 2."""
    product = load_product(path)
    if product.get("composition"):
        raise InputError(
            f"{product.get('name')!r} is a shade made of a material; read it with"
            " read_layer",
            file=path,
        )
    return pane_of(product, path)


def load_product(path: str | Path) -> dict[str, Any]:
    """Return the JSON object in a file."""
    product = read_json(path)
    if isinstance(product, list) and len(product) == 1:
        product = product[0]
    if not isinstance(product, dict):
        raise InputError("a JSON object with one product expected", file=path)
    return product


def pane_of(product: dict[str, Any], path: str | Path) -> Pane:
    """Return the pane that a product describes."""
    physical = product.get("physical_properties") or product.get("measured_data") or {}
    if not isinstance(physical, dict):
        raise InputError("measured data that are not a JSON object", file=path)
    rows = _rows(product, path)
    wavelength = np.array([row["wavelength"] for row in rows])
    order = np.argsort(wavelength, kind="stable")
    direct, diffuse = (_optics(rows, order, kind) for kind in ("specular", "diffuse"))
    subtype = str(product.get("subtype") or product.get("type") or "").lower()
    pane = _checked(
        path,
        name=str(product.get("name") or Path(path).stem),
        wavelength_nm=wavelength[order] * _MICROMETRE_NM,
        direct=direct,
        diffuse=diffuse if _any(diffuse) else None,
        coated=subtype in _COATED,
        thickness=_number(physical, "thickness", 3.0, path) * _MILLIMETRE,
        conductivity=_number(physical, "conductivity", GLASS_CONDUCTIVITY, path),
        emissivity_front=_either(physical, "emissivity_front", GLASS_EMISSIVITY, path),
        emissivity_back=_either(physical, "emissivity_back", GLASS_EMISSIVITY, path),
        infrared_transmittance=_either(physical, "tir_front", 0.0, path),
        coated_side=_coated_side(product),
        manufacturer=str(
            product.get("manufacturer_name") or product.get("manufacturer") or ""
        ),
        nfrc_id=_identity(product),
        source=str(path),
    )
    warn_of_excess(pane)
    return pane


def warn_of_excess(pane: Pane) -> None:
    """Warn if the transmittance plus reflectance of a pane exceeds 1.01."""
    passed = pane.at(pane.wavelength_nm)
    most = np.maximum(
        passed.transmission_front + passed.reflection_front,
        passed.transmission_back + passed.reflection_back,
    )
    if most.max() > 1.01:
        at = pane.wavelength_nm[int(np.argmax(most))]
        warnings.warn(
            f"{pane.source}: {pane.name!r} scatters {most.max():.3f} times the"
            f" incident flux at {at:g} nm; at most 1 expected",
            ClerestoryWarning,
            stacklevel=4,
        )


def _rows(product: dict[str, Any], path: str | Path) -> list[dict[str, Any]]:
    # Spectral table (version 1 or 2) as rows of wavelength, specular and diffuse values
    try:
        if "physical_properties" in product:
            optical = product["physical_properties"]["optical_properties"]
            blocks = optical["optical_data"]["angle_blocks"]
            found = [_row_of_version_2(row) for row in blocks[0]["wavelength_data"]]
        else:
            spectral = product["spectral_data"]
            table = (
                spectral["spectral_data"] if isinstance(spectral, dict) else spectral
            )
            found = [_row_of_version_1(row) for row in table]
    except (KeyError, TypeError, IndexError, ValueError, AttributeError) as error:
        raise InputError(
            f"{product.get('name')!r} has no readable spectral data"
            f" ({type(error).__name__}: {error}); T, Rf, Rb over wavelength expected",
            file=path,
        ) from error
    if not found:
        raise InputError(
            f"{product.get('name')!r} has an empty spectral table; rows expected",
            file=path,
        )
    return found


def _row_of_version_1(row: dict[str, Any]) -> dict[str, Any]:
    t, rf, rb = (float(row[key]) for key in ("T", "Rf", "Rb"))
    return {"wavelength": float(row["wavelength"]), "specular": (t, t, rf, rb)}


def _row_of_version_2(row: dict[str, Any]) -> dict[str, Any]:
    shares: dict[str, Any] = {"wavelength": float(row["w"])}
    for kind in ("specular", "diffuse"):
        if row.get(kind):
            shares[kind] = tuple(float(row[kind][k]) for k in ("tf", "tb", "rf", "rb"))
    return shares


def _optics(rows: list[dict[str, Any]], order: np.ndarray, kind: str) -> Optics:
    table = np.array([row.get(kind, (0.0,) * 4) for row in rows])[order]
    return Optics(*table.T.copy())


def _any(optics: Optics) -> bool:
    return any(np.any(share > 0) for share in vars(optics).values())


def _checked(path: str | Path, **fields: Any) -> Pane:
    try:
        return Pane(**fields)
    except InputError as error:
        raise InputError(error.message, file=path) from error


def _number(
    physical: dict[str, Any], key: str, default: float, path: str | Path
) -> float:
    value = physical.get(key)
    if value is None:
        return default
    try:
        number = float(value)
    except (TypeError, ValueError):
        number = math.nan
    if not math.isfinite(number):
        raise InputError(f"{key} is {str(value)[:40]!r}; a number expected", file=path)
    return number


def _either(
    physical: dict[str, Any], key: str, default: float, path: str | Path
) -> float:
    # Version 2 marks unmeasured values as predefined
    predefined = _number(physical, f"predefined_{key}", default, path)
    return _number(physical, key, predefined, path)


def _coated_side(product: dict[str, Any]) -> str:
    side = str(product.get("coated_side") or "neither").lower()
    return side if side in ("front", "back", "both") else "neither"


def _identity(product: dict[str, Any]) -> int | None:
    number = product.get("nfrc_id")
    return number if isinstance(number, int) else None
