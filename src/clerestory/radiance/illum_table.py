"""Precomputed window emitters: radiance tables and files.

As in mkillum, a window becomes an emitter (`illum`) with a radiance table over polar
angle and azimuth, which is interpolated; the camera sees the material of the window.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from jaxtyping import Float

from clerestory.brief_repr import brief
from clerestory.errors import InputError
from clerestory.escaping import file_stem, radiance_name
from clerestory.files import replace_file
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import Name, parse_expression
from clerestory.radiance.data_array import DataArray
from clerestory.radiance.function_pattern import FunctionPattern
from clerestory.radiance.rad_writer import primitive_text
from clerestory.scene.model import Illum, Polygon, Scene, Void
from clerestory.scene.primitive import primitive

# Polar angle of the emission direction −D from the normal (A1, A2, A3); azimuth of −D
# from (A4, A5, A6) towards (A7, A8, A9)
_FROM_NORMAL = "Acos(-(Dx*A1+Dy*A2+Dz*A3))/DEGREE"
_AROUND = "Atan2(-(Dx*A7+Dy*A8+Dz*A9),-(Dx*A4+Dy*A5+Dz*A6))/DEGREE"
_COLOUR, _GREY = ("red", "green", "blue"), ("noop",)

# Quadrature points per table row in the integral of the exitance
_FINE = 20


@dataclass(frozen=True, eq=False)
class LeavingLight:
    """Outgoing radiance of a planar patch [W/(m²·sr)].

    The axes of `radiance` are polar angle, azimuth and channel. The rows of `frame` are
    two axes in the plane of the patch, and the normal of the patch.
    """

    frame: Float[np.ndarray, "3 3"]
    radiance: Float[np.ndarray, "ring sector 3"]

    __repr__ = brief


def light_pattern(light: LeavingLight) -> FunctionPattern:
    """Return the pattern that gives an emitter of radiance 1 the radiance of a patch.

    The table has radiances at the centres of polar angle and azimuth intervals, scaled
    so that the interpolated table has the same exitance as `light`.
    """
    grey = bool(np.ptp(light.radiance, axis=2).max() == 0)
    tables = [_table(light.radiance[..., c]) for c in range(1 if grey else 3)]
    return FunctionPattern(
        Program(),
        tuple(Name(name) for name in (_GREY if grey else _COLOUR)),
        tuple(float(x) for x in light.frame[[2, 0, 1]].ravel()),
        tables=tuple(tables),
        coordinates=(parse_expression(_FROM_NORMAL), parse_expression(_AROUND)),
    )


def _table(radiance: Float[np.ndarray, "ring sector"]) -> DataArray:
    # Extends the table to polar angles of 0° and 90° and beyond azimuths of ±180°
    rings, sectors = radiance.shape
    ring, sector = 90 / rings, 360 / sectors
    first = np.full((1, sectors), radiance[0].mean())
    closed = np.concatenate([first, radiance, radiance[-1:]])
    closed = np.concatenate([closed[:, -1:], closed, closed[:, :1]], axis=1)
    middles = (np.arange(rings) + 0.5) * ring
    theta = np.concatenate([[0.0], middles, [90.0]])
    phi = -180 + sector * (np.arange(sectors + 2) - 0.5)
    table = DataArray((theta, phi), closed)
    # Projected solid angle of each ring of polar angles [sr]
    weight = np.pi * np.diff(np.sin(np.linspace(0, np.pi / 2, rings + 1)) ** 2)
    sent = float(radiance.mean(axis=1) @ weight)
    read = _exitance_of(table)
    return DataArray(table.axes, closed * (sent / read)) if read > 0 else table


def _exitance_of(table: DataArray) -> float:
    # Exitance 2π ∫ L sin θ cos θ dθ, by the midpoint rule
    count = _FINE * len(table.axes[0])
    theta = (np.arange(count) + 0.5) * 90 / count
    phi = np.linspace(-180, 180, 4 * len(table.axes[1]), endpoint=False)
    at = np.stack(np.meshgrid(theta, phi, indexing="ij"), axis=-1).reshape(-1, 2)
    mean = table.value(at).reshape(count, -1).mean(axis=1)
    weight = np.pi * np.sin(2 * np.radians(theta)) * np.radians(90 / count)
    return float(mean @ weight)


def write_illums(scene: Scene, path: str | Path) -> list[Path]:
    """Write precomputed window emitters as a Radiance scene file and data files.

    The scene file must be read after the file that defines the alternate materials of
    the windows. Each data file has the stem of the scene file and a number. The paths
    of all files are returned.

    Parameters
    ----------
    scene : window emitters, as returned by `precompute_illums`
    path : scene file (.rad) to write
    """
    path = Path(path)
    lines, files = ["# Precomputed window emitters, by Clerestory"], []
    for number, surface in enumerate(scene.surfaces):
        lamp = scene.materials[surface.material]
        if not (
            isinstance(surface, Polygon)
            and isinstance(lamp, Illum)
            and isinstance(lamp.pattern, FunctionPattern)
        ):
            raise InputError(
                f'surface "{surface.name}" is not a window emitter; surfaces from'
                " `precompute_illums` expected"
            )
        names = []
        for table, channel in zip(lamp.pattern.tables, "rgb", strict=False):
            names.append(f"{file_stem(path.stem)}_{number}{channel}.dat")
            files.append(path.with_name(names[-1]))
            with replace_file(files[-1]) as stream:
                stream.write(_data_text(table).encode())
        lines += _lamp_lines(surface, lamp, lamp.pattern, names)
    with replace_file(path) as stream:
        stream.write("\n".join([*lines, ""]).encode())
    return [path, *files]


def _lamp_lines(
    surface: Polygon, lamp: Illum, pattern: FunctionPattern, names: list[str]
) -> list[str]:
    coloured = len(names) == 3
    kind, functions = ("colordata", _COLOUR) if coloured else ("brightdata", _GREY)
    light, name = map(radiance_name, (f"{lamp.name}_light", lamp.name))
    behind = lamp.alternate
    shown = "void" if isinstance(behind, Void) else radiance_name(behind.name)
    words = (*functions, *names, ".", _FROM_NORMAL, _AROUND)
    polygon = radiance_name(surface.name or lamp.name)
    made = (
        primitive("void", kind, light, pattern.arguments, words),
        primitive(light, "illum", name, lamp.radiance, (shown,)),
        primitive(name, "polygon", polygon, surface.vertices),
    )
    return [primitive_text(item) for item in made]


def _data_text(table: DataArray) -> str:
    # Polar angles are not equidistant and therefore listed; azimuths are equidistant
    theta, phi = table.axes
    uneven = " ".join(f"{x:.9g}" for x in theta)
    rows = "\n".join(" ".join(f"{x:.7g}" for x in row) for row in table.values)
    return (
        f"2\n0 0 {len(theta)} {uneven}\n{phi[0]:.9g} {phi[-1]:.9g} {len(phi)}\n{rows}\n"
    )
