"""Optional dependency on OpenCV."""

import importlib
import importlib.util
from typing import Any

from clerestory.errors import ClerestoryError


def opencv() -> Any:
    """Return the module `cv2` of OpenCV, imported when it is needed."""
    if importlib.util.find_spec("cv2") is None:
        raise ClerestoryError(
            "OpenCV is not installed; run `pip install clerestory[capture]`"
        )
    return importlib.import_module("cv2")
