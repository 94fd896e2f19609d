"""A layer from a file, whether it was exported or is a fit of measurements itself.

Fits are evaluated as they are, at the resolution of their lobes; what needs patches
averages them. Their reader is loaded when it is needed: it brings the solver of
optimal transport along.
"""

import importlib
from pathlib import Path

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_reader import read_bsdf

_SUFFIX = ".nc"


def read_layer(path: str | Path) -> Bsdf:
    """Return the layer of a BSDF file (.xml), or of fitted measurements (.nc).

    Raises
    ------
    InputError : not such a file, or damaged
    """
    if Path(path).suffix.lower() != _SUFFIX:
        return read_bsdf(path)
    storage = importlib.import_module("clerestory.gonio.fit_storage")
    fitted = importlib.import_module("clerestory.gonio.fitted_measurement")
    bsdf: Bsdf = fitted.measured_bsdf(storage.read_fits(path), source=str(path))
    return bsdf
