"""Optional dependency on OpenCV."""

import importlib
import importlib.util
from typing import Any

from clerestory.errors import ClerestoryError


def opencv() -> Any:
    """Return OpenCV's module."""
    if importlib.util.find_spec("cv2") is None:
        raise ClerestoryError(
            "OpenCV is not installed; `pip install clerestory[capture]` expected"
        )
    return importlib.import_module("cv2")
