"""Annual glare from a sequence of pictures of one view.

The pictures are evaluated one by one and need not be stored. Quantities that depend on
the view alone, such as solid angles and position indices, are computed once.
"""

import importlib
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from clerestory.array_types import EachImage
from clerestory.checks import require, same_length
from clerestory.errors import ClerestoryWarning
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.evaluate import evaluate_luminance
from clerestory.glare.glare_view import GlareView, glare_view
from clerestory.glare.index_settings import (
    EVALGLARE,
    Background,
    DgpCoefficients,
    IndexSettings,
)
from clerestory.glare.indices import REPORTED
from clerestory.glare.sources import SourceSearch, warn_if_coarse
from clerestory.glare.uncertainty import UncertainLuminance
from clerestory.glare.undersampled_sources import UndersampledSources
from clerestory.scene.view import View

if TYPE_CHECKING:
    import xarray as xr

_UNITS = {quantity.name: quantity.unit for quantity in REPORTED}


def annual_glare(
    luminance: Iterable[EachImage | UncertainLuminance],
    view: View,
    *,
    times: np.ndarray | None = None,
    illuminance: Float[np.ndarray, " step"] | None = None,
    rules: SourceRules | None = None,
    background: Background = "cie",
    low_light: bool = False,
    coefficients: DgpCoefficients = EVALGLARE,
    name: str = "the pictures",
    check_pixels: bool = True,
    progress: Callable[[int], None] | None = None,
) -> "xr.Dataset":
    """Return the glare indices of a sequence of pictures.

    Parameters
    ----------
    luminance : luminance of the pixels [cd/m²]: an array (step, row, column), or an
        iterable of pictures, such as a generator over the results of a five-phase
        study; pictures that are `UncertainLuminance` give standard errors
    view : common view of all pictures
    times : time of each picture, the coordinate "time" of the result; default: a
        coordinate "step" of picture numbers
    illuminance : measured vertical illuminance per time step, for DGP [lux]; default:
        from the pictures
    rules, background, low_light, coefficients : see `evaluate_glare`
    name : name of the pictures in warnings
    check_pixels : whether to warn of too few pixels for the merging of sources
    progress : callback with the number of completed pictures

    Returns
    -------
    dataset with one variable per index, and one value per picture; if pictures have
    errors, also the standard error of each index, such as "dgp_error"

    Raises
    ------
    InputError : pictures differ in size, the number of times or illuminances is wrong,
        or a luminance is negative or not finite

    Examples
    --------
    >>> eye = View(kind="angular", horizontal=180, vertical=180)
    >>> year = np.full((3, 160, 160), 100.0)
    >>> year[1, 50:75, 50:75] = 20_000.0
    >>> annual_glare(year, eye).dgp.values.round(2).tolist()
    [0.18, 0.47, 0.18]
    """
    rules = rules or SourceRules()
    settings = IndexSettings(background, None, low_light, None, coefficients)
    results = []
    undersampled: dict[str, UndersampledSources] = {}
    search: SourceSearch | None = None
    for step, (picture, eye) in enumerate(_checked(luminance, view)):
        if step == 0 and check_pixels:
            warn_if_coarse(eye, rules, name=name)
        search = search or SourceSearch(eye, rules)
        given = replace(settings, given_illuminance=_at(illuminance, step))
        _, result, poor = evaluate_luminance(picture, search, given)
        errors = {f"{key}_error": error for key, error in result.errors.items()}
        results.append(result.values() | errors)
        if poor is not None:
            moment = f"picture {step}" if times is None else str(times[step])[:16]
            undersampled[moment] = poor
        if progress is not None:
            progress(step + 1)
    if undersampled:
        moment, worst = max(undersampled.items(), key=lambda item: item[1].share)
        warnings.warn(f"{name}, {moment}: {worst.words()}", ClerestoryWarning, 2)
    for what, values in (("times", times), ("illuminances", illuminance)):
        if values is not None:
            same_length(values, results, what, "pictures")
    require(results, "no pictures; at least one expected")
    return glare_dataset([results], times).squeeze("view", drop=True)


def _checked(
    luminance: Iterable[EachImage | UncertainLuminance], view: View
) -> Iterator[tuple[EachImage | UncertainLuminance, GlareView]]:
    # Check each picture; yield it with the pixel quantities of the common view
    eye = None
    for step, given in enumerate(luminance):
        picture = given.value if isinstance(given, UncertainLuminance) else given
        if eye is None:
            rows, columns = picture.shape
            eye = glare_view(view, columns, rows)
        require(
            picture.shape == eye.shape,
            f"picture {step} has {picture.shape[1]} × {picture.shape[0]} pixels;"
            f" {eye.shape[1]} × {eye.shape[0]} expected, as in the first picture",
        )
        require(
            picture.min() >= 0 and np.isfinite(picture.max()),
            f"picture {step} has negative or non-finite luminances; finite numbers of 0"
            " or more expected",
        )
        yield given, eye


def _at(illuminance: np.ndarray | None, step: int) -> float | None:
    if illuminance is None:
        return None
    require(
        step < len(illuminance),
        f"{len(illuminance)} illuminances, but more pictures; one per picture expected",
    )
    return float(illuminance[step])


def glare_dataset(
    results: Sequence[Sequence[Mapping[str, float]]], times: np.ndarray | None
) -> "xr.Dataset":
    """Return glare indices by name, of each step of each view, as a dataset."""
    axis = "step" if times is None else "time"
    steps = np.arange(len(results[0])) if times is None else times
    units = _UNITS | {f"{name}_error": unit for name, unit in _UNITS.items()}
    variables = {
        name: (
            ("view", axis),
            [[step.get(name, np.nan) for step in one] for one in results],
            {"units": unit},
        )
        for name, unit in units.items()
        if any(name in step for one in results for step in one)
    }
    # Imported here, since xarray loads slowly
    dataset: type[xr.Dataset] = importlib.import_module("xarray").Dataset
    return dataset(variables, coords={axis: steps})
