"""Reader of layers from BSDF files or from files of fitted measurements.

The reader of fitted measurements, which needs the optimal transport solver, is imported
on demand.
"""

import importlib
from pathlib import Path

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.xml_reader import read_bsdf

_SUFFIX = ".nc"


def read_layer(path: str | Path) -> Bsdf:
    """Read a layer from a BSDF file (.xml) or from fitted measurements (.nc)."""
    if Path(path).suffix.lower() != _SUFFIX:
        return read_bsdf(path)
    storage = importlib.import_module("clerestory.gonio.fit_storage")
    fitted = importlib.import_module("clerestory.gonio.fitted_measurement")
    bsdf: Bsdf = fitted.measured_bsdf(storage.read_fits(path), source=str(path))
    return bsdf
