"""Façade matrices of exterior shades in front of a window, such as awnings and grates.

    F  exterior patches of the window × exterior patches of a port     facade_matrix

*Ports* (F apertures) are virtual surfaces that, with the wall, enclose the window and
its shade. Ports are `Window` objects; the front faces the enclosed space. Light enters
through a port and reaches the window directly or via the shade. D leads from the sky to
the ports. A change of the shade changes F alone, not V or D. With the sum of F D over
the ports in place of D, `three_phase` and `five_phase` compute the four-phase and
six-phase methods.

Reference: S. Subramaniam, Daylighting simulations with Radiance using matrix-based
methods, LBNL, 2017, chapter 7; the F matrix is due to G. Ward (2015).
"""

import warnings
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Unpack

import numpy as np

from clerestory.engine.controller import estimate
from clerestory.engine.effort import EffortKeywords
from clerestory.engine.matrix_jobs import FacadeJob
from clerestory.errors import ClerestoryWarning
from clerestory.matrix.axis import window_axis
from clerestory.matrix.derivatives import Derivatives
from clerestory.matrix.transfer_matrix import TransferMatrix, require_matrix
from clerestory.phases.traced_matrices import (
    Differentiated,
    matrix_effort,
    patch_axes,
    require_distinct,
    split_columns,
    warn_if_short,
)
from clerestory.scene.material_parameters import material_parameters
from clerestory.scene.model import Scene
from clerestory.scene.window import Window


def facade_matrix(
    scene: Scene, window: Window, port: Window, **keywords: Unpack[EffortKeywords]
) -> TransferMatrix:
    """Façade matrix of one port: window patch radiance per port patch radiance.

    See `facade_matrices`.
    """
    effort = matrix_effort(facade_matrix, keywords)
    return facade_matrices(scene, window, [port], effort=effort)[port.name]


def facade_matrices(
    scene: Scene,
    window: Window,
    ports: Sequence[Window],
    *,
    derivatives: Differentiated = (),
    **keywords: Unpack[EffortKeywords],
) -> dict[str, TransferMatrix]:
    """Façade matrices of several ports, traced together, by port name.

    Each row sums to one over all ports if the ports enclose the window without gaps and
    without a shade. Light that enters through gaps is neglected.

    Parameters
    ----------
    scene : surfaces between the ports and the window
    window : polygons whose front faces the room
    ports : F apertures whose front faces the window, one for each orientation
    samples : number of paths per window patch
    relative_error : instead of samples: target standard error of the window irradiance
        due to one port patch (RMS over the patches), relative to the mean irradiance
    bounces : maximum number of reflections, as Radiance -ab; default unlimited

    The other parameters are those of `view_matrix`.

    Raises
    ------
    InputError : samples and relative_error both given, or a number out of range; a
        port has the same name as another port or the window
    DeviceError : no usable compute device

    Examples
    --------
    >>> import numpy as np
    >>> from clerestory.directions import Frame
    >>> from clerestory.hemisphere.klems import klems
    >>> from clerestory.scene.model import Polygon, Scene
    >>> frame = Frame.from_normal_up(np.eye(3)[1], np.eye(3)[2])
    >>> def pane(name, size, y):
    ...     corners = [[-1, y, -1], [-1, y, 1], [1, y, 1], [1, y, -1]]
    ...     vertices = np.array(corners) * [size, 1, size]
    ...     return Window(name, (Polygon(vertices, "", ""),), frame, klems("quarter"))
    >>> window, port = pane("window", 1, 0.0), pane("port", 500, -1.0)
    >>> F = facade_matrix(Scene(), window, port, samples=64, device="cpu")
    >>> F.values.shape, round(float(F.values[0, 0].sum()), 6)
    ((1, 41, 41), 1.0)
    """
    require_distinct([window, *ports])
    effort = matrix_effort(facade_matrices, keywords)
    options = effort.job_options()
    job = FacadeJob(
        scene=scene,
        window=window,
        ports=tuple(ports),
        derivatives=material_parameters(scene, derivatives),
        **options,
    )
    estimated = estimate(job, effort)
    warn_if_short(estimated, f"façade matrix of {window.name!r}", effort)
    rows = window_axis("exterior", window.partition, window.name)
    found = split_columns(estimated, rows, patch_axes(ports, "exterior"), scene.bands)
    for name, matrix in found.items():
        if estimated.paths and not matrix.values.any():
            warnings.warn(
                f"no light of port {name!r} reaches window {window.name!r}; a port"
                " whose front faces the window expected",
                ClerestoryWarning,
                stacklevel=2,
            )
    return found


def facade_daylight(
    facade: Mapping[str, TransferMatrix], daylight: Mapping[str, TransferMatrix]
) -> TransferMatrix:
    """Daylight matrix of a window behind an exterior shade: Σ F D over the ports.

    Parameters
    ----------
    facade : F of each port, from one call of `facade_matrices`
    daylight : D of each port, from `daylight_matrices`
    """
    require_matrix(
        facade and facade.keys() == daylight.keys(),
        f"façade matrices of ports {', '.join(facade) or 'none'}, daylight matrices of"
        f" {', '.join(daylight) or 'none'}; the same ports expected",
    )
    return joint_sum([facade[port] @ daylight[port] for port in facade])


def joint_sum(terms: Sequence[TransferMatrix]) -> TransferMatrix:
    """Sum of matrices, some of which were estimated from the same paths.

    Matrices with equally many error components are summed component by component: the
    variance is exact for common paths and unbiased for independent paths. Matrices with
    different numbers of error components are assumed to be independent.
    """
    total = terms[0]
    for term in terms[1:]:
        one, other = total.components, term.components
        total = total + term
        if one is not None and other is not None and len(one) == len(other):
            total = replace(
                total,
                components=one + other,
                derivatives=_jointly(total.derivatives, len(one)),
            )
    return total


def _jointly(derivatives: Derivatives | None, count: int) -> Derivatives | None:
    # Derivatives of a sum, of whose error components the first `count` belong to one
    # matrix and as many to the other, estimated from the same paths
    if derivatives is None or derivatives.components is None:
        return derivatives
    one, other = np.split(derivatives.components, [count])
    return replace(derivatives, components=one + other)
