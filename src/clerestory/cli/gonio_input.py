"""What the commands of `clerestory gonio` make of their arguments."""

from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.bsdf.scattering_function import Function
from clerestory.cli.two_angles import two_angles
from clerestory.errors import InputError
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.formats.file_format import Facing
from clerestory.gonio.measurement_files import read_measurement
from clerestory.gonio.scattering_measurement import Measurement

_PICTURES = (".png", ".svg", ".pdf")


def read_files(
    files: list[Path],
    form: str | None,
    function: Function | None,
    facing: Facing,
    blank: Path | None,
    *,
    merge: bool,
) -> tuple[Measurement, ...]:
    """Return the measurements of files."""
    return read_measurement(
        *files, form=form, function=function, facing=facing, blank=blank, merge=merge
    )


def picture_format(output: Path) -> str:
    """Return the format of a picture by its name."""
    kind = output.suffix.lower()
    if kind not in _PICTURES:
        raise InputError(
            f"picture {output.name!r}; a name in {', '.join(_PICTURES)} expected"
        )
    return kind[1:]


def direction_of(text: str) -> Float[np.ndarray, "3"]:
    """Return the direction of two angles with a comma between."""
    theta, phi = two_angles(text)
    if not 0 <= theta < 90:
        raise InputError(f"direction {text!r}; θ from 0 to below 90° expected")
    return from_degrees(theta, phi)
