"""Names of surfaces in messages."""

from clerestory.scene.model import Surface


def item(surface: Surface) -> str:
    """Return the place of a surface in its file, its kind and its name.

    >>> import numpy as np
    >>> from clerestory.scene.model import Sphere
    >>> item(Sphere(np.zeros(3), 1.0, False, "grey", "ball"))
    'sphere "ball"'
    """
    kind = type(surface).__name__.lower()
    place = ""
    if surface.source is not None and surface.source.file:
        place = f"{surface.source.file}:{surface.source.line}: "
    return f'{place}{kind} "{surface.name}"'
