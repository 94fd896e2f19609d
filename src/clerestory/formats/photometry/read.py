"""Reader of luminaires from IES and EULUMDAT files."""

import warnings
from pathlib import Path

from clerestory.errors import ClerestoryWarning
from clerestory.formats.photometry.eulumdat import read_eulumdat
from clerestory.formats.photometry.ies import read_ies
from clerestory.formats.photometry.luminaire import Luminaire

LUMINAIRE_SUFFIXES = (".ies", ".ldt")

# Ratio of luminaire flux to lamp flux above which a warning is given
_MOST_OUTPUT = 1.02


def read_luminaire(path: str | Path) -> Luminaire:
    r"""Read a luminaire from an IES (LM-63) or EULUMDAT (.ldt) file.

    Raises
    ------
    InputError : the file is missing or malformed

    Warns
    -----
    ClerestoryWarning : the flux of the luminaire exceeds the flux of its lamps

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
    lamps, flux = luminaire.lamp_lumens, luminaire.flux()
    if lamps and flux > _MOST_OUTPUT * lamps:
        warnings.warn(
            f"{path}: the flux of the luminaire is {flux:.0f} lm, {flux / lamps:.0%} of"
            f" the {lamps:.0f} lm of its lamps; less than 100 % expected",
            ClerestoryWarning,
            stacklevel=2,
        )
    return luminaire
