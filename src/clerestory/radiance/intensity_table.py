"""Luminous intensity distributions as tables for brightdata (ies2rad)."""

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.errors import InputError
from clerestory.formats.photometry.luminaire import Luminaire
from clerestory.radiance.data_array import DataArray


def intensity_table(luminaire: Luminaire) -> DataArray:
    """Return the radiant intensity [W/sr] as a table over `table_coordinates`."""
    value = luminaire.intensity / LUMINOUS_EFFICACY
    if len(luminaire.horizontal_deg) == 1:
        return DataArray((luminaire.vertical_deg,), value[0])
    return DataArray((luminaire.horizontal_deg, luminaire.vertical_deg), value)


def table_coordinates(luminaire: Luminaire) -> tuple[str, ...]:
    """Return the functions of source.cal for the angles along the table's axes."""
    if luminaire.photometry == "A":
        raise InputError(
            f'luminaire "{luminaire.name}" has photometry of type A; B or C expected'
        )
    if luminaire.photometry == "B":
        return ("srcB_horiz", "srcB_vert")
    if len(luminaire.horizontal_deg) == 1:
        return ("src_theta",)
    return ("src_phi", "src_theta")
