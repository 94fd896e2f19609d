"""Window groups: polygons with a common angular basis.

The polygons are coplanar or parallel, but for the ports of façade matrices, which may
enclose a shade on several sides.
"""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.array_types import Vector
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.directions import Frame, unit
from clerestory.errors import located
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition
from clerestory.scene.material import error_at
from clerestory.scene.surface import Polygon, area_vectors
from clerestory.scene.triangulate import Triangles, triangulate

# Maximum angle between polygon normal and window normal [deg]
_SAME_NORMAL_DEG = 0.5


@checked_fields
@dataclass(frozen=True, eq=False)
class Window:
    """A window group: polygons with a common normal, whose fronts face the room.

    Attributes
    ----------
    name : modifier of the polygons, or name of the file
    frame : its normal points into the room
    partition : angular basis of front and back
    faceted : whether the normals of polygons may differ, as those of a port that
        encloses a shade: light of a direction then enters by every polygon that it
        meets from behind

    Raises
    ------
    InputError : the normal of a polygon differs from the normal of the window group
    """

    name: str
    polygons: tuple[Polygon, ...]
    frame: Frame
    partition: RingPartition
    faceted: bool = False

    __repr__ = brief

    def __post_init__(self) -> None:
        require(
            self.polygons, f'window "{self.name}" has no polygons; one or more expected'
        )
        cosine = unit(_normals(self.polygons)) @ self.frame.normal
        worst = int(np.argmin(cosine))
        angle = np.degrees(np.arccos(np.clip(cosine[worst], -1, 1)))
        if angle > _SAME_NORMAL_DEG and not self.faceted:
            polygon = self.polygons[worst]
            raise error_at(
                polygon.source,
                f'the normal of polygon "{polygon.name}" differs by {angle:.2f}° from'
                f' that of window "{self.name}"; one normal per window expected, one'
                " modifier for each orientation",
            )

    @property
    def area(self) -> float:
        """Area of all polygons [m²]."""
        return float(sum(t.areas().sum() for t in self.triangles()))

    def triangles(self) -> tuple[Triangles, ...]:
        """Return triangles that fill each polygon, with fronts facing the room."""
        return tuple(triangulate(p.vertices) for p in self.polygons)


def window_of(
    polygons: tuple[Polygon, ...],
    *,
    name: str,
    up: Vector | None = None,
    partition: RingPartition | None = None,
    faceted: bool = False,
) -> Window:
    """Return a window group; the area-weighted mean normal defines its frame.

    By default `up` is +z, or +y for a horizontal window, and the basis is Klems full.
    """
    normal = unit(_normals(polygons).sum(axis=0))
    if up is None:
        up = np.array([0.0, 0.0, 1.0] if abs(normal[2]) < 0.9999 else [0.0, 1.0, 0.0])
    place = vars(polygons[0].source) if polygons[0].source else {"file": None}
    with located(**place, subject=f'window "{name}"'):
        frame = Frame.from_normal_up(normal, up)
    return Window(name, polygons, frame, partition or klems("full"), faceted)


def are_parallel(polygons: tuple[Polygon, ...]) -> bool:
    """Whether the normals of all polygons are near their mean."""
    normals = _normals(polygons)
    least = (unit(normals) @ unit(normals.sum(axis=0))).min()
    return bool(least >= np.cos(np.radians(_SAME_NORMAL_DEG)))


def _normals(polygons: tuple[Polygon, ...]) -> Float[np.ndarray, "polygons 3"]:
    first = np.cumsum([0, *(len(p.vertices) for p in polygons)])
    return area_vectors(np.concatenate([p.vertices for p in polygons]), first)
