"""Luminaires from files of either format."""

from pathlib import Path

from clerestory.scene.photometry.eulumdat import read_eulumdat
from clerestory.scene.photometry.ies import read_ies
from clerestory.scene.photometry.luminaire import Luminaire

LUMINAIRE_SUFFIXES = (".ies", ".ldt")


def read_luminaire(path: str | Path) -> Luminaire:
    r"""Return the luminaire in an IES (LM-63) or EULUMDAT (.ldt) file.

    Raises
    ------
    InputError : with file and line, where it is missing or malformed

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
    if Path(path).suffix.lower() == ".ldt":
        return read_eulumdat(path)
    return read_ies(path)
