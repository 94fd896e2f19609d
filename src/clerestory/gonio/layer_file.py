"""Reader of layers from BSDF files or from files of fitted measurements.

Fitted measurements are used at the resolution of their lobes. Their reader is imported
on demand because it imports the optimal transport solver.
"""

import importlib
from pathlib import Path

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_reader import read_bsdf

_SUFFIX = ".nc"


def read_layer(path: str | Path) -> Bsdf:
    """Return the layer of a BSDF file (.xml), or of fitted measurements (.nc)."""
    if Path(path).suffix.lower() != _SUFFIX:
        return read_bsdf(path)
    storage = importlib.import_module("clerestory.gonio.fit_storage")
    fitted = importlib.import_module("clerestory.gonio.fitted_measurement")
    bsdf: Bsdf = fitted.measured_bsdf(storage.read_fits(path), source=str(path))
    return bsdf
