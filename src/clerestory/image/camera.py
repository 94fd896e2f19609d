"""Receivers of radiance: pixels of a picture, cells of the sphere, or given rays."""

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.array_types import Vector
from clerestory.bands import RGB, Bands
from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.image.picture import Picture
from clerestory.scene.ray_bundles import RayBundles
from clerestory.scene.scaling import scaled
from clerestory.scene.sphere_cells import SphereCells
from clerestory.scene.view import View


@checked_fields
@dataclass(frozen=True, eq=False)
class Camera:
    """View and size of a picture."""

    view: View
    columns: int
    rows: int

    __repr__ = brief

    def __post_init__(self) -> None:
        message = (
            f"a picture of {self.columns} × {self.rows} pixels; 1 to 2^24 expected"
        )
        require(min(self.columns, self.rows) >= 1 and len(self) <= 1 << 24, message)

    def __len__(self) -> int:
        return self.columns * self.rows

    @property
    def position(self) -> Vector:
        """Viewpoint [m]."""
        return self.view.position

    def scaled(self, factor: float) -> "Camera":
        """Return the camera with all lengths multiplied."""
        return replace(self, view=scaled(self.view, factor))

    def picture(
        self,
        radiance: Float[np.ndarray, "band pixel"],
        *header: str,
        bands: Bands = RGB,
    ) -> Picture:
        """Return the picture of the given pixel radiances."""
        pixels = np.moveaxis(radiance, 0, -1).reshape(self.rows, self.columns, -1)
        values = pixels.astype(np.float32)
        return Picture(values, view=self.view, header=header, bands=bands)


# What radiance is traced for: pixels of a picture, cells of the sphere, or given rays
PixelsOrCells = Camera | SphereCells | RayBundles
