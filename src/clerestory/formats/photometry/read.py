"""Luminaires from files of either format."""

import warnings
from pathlib import Path

from clerestory.errors import ClerestoryWarning
from clerestory.formats.photometry.eulumdat import read_eulumdat
from clerestory.formats.photometry.ies import read_ies
from clerestory.formats.photometry.luminaire import Luminaire

LUMINAIRE_SUFFIXES = (".ies", ".ldt")

# Share of the lamps' flux above which a file contradicts itself
_MOST_OUTPUT = 1.02


def read_luminaire(path: str | Path) -> Luminaire:
    r"""Return the luminaire in an IES (LM-63) or EULUMDAT (.ldt) file.

    Raises
    ------
    InputError : with file and line, where it is missing or malformed

    Warns
    -----
    ClerestoryWarning : more light leaves than the lamps have

    Examples
    --------
    >>> import tempfile
    >>> text = "IESNA:LM-63-2002\nTILT=NONE\n1 -1 1 3 1 1 2 -.2 -.2 0\n1 1 10\n"
    >>> text += "0 45 90\n0\n100 80 0\n"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "lamp.ies")
    ...     _ = file.write_text(text)
    ...     lamp = read_luminaire(file)
    >>> lamp.shape.kind, round(lamp.flux())
    ('cylinder', 328)
    """
    eulumdat = Path(path).suffix.lower() == ".ldt"
    luminaire = read_eulumdat(path) if eulumdat else read_ies(path)
    _doubt_flux(luminaire, path)
    return luminaire


def _doubt_flux(luminaire: Luminaire, path: str | Path) -> None:
    lamps, flux = luminaire.lamp_lumens, luminaire.flux()
    if lamps and flux > _MOST_OUTPUT * lamps:
        warnings.warn(
            f"{path}: its intensities send {flux:.0f} lm, {flux / lamps:.0%} of the"
            f" {lamps:.0f} lm of its lamps; less than 100 % expected",
            ClerestoryWarning,
            stacklevel=3,
        )
