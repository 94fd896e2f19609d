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
from clerestory.glare.glare_view import glare_view
from clerestory.glare.index_settings import (
    EVALGLARE,
    Background,
    DgpCoefficients,
    IndexSettings,
)
from clerestory.glare.indices import REPORTED, Glare
from clerestory.glare.sources import SourceSearch, warn_if_coarse
from clerestory.glare.uncertainty import UncertainLuminance
from clerestory.glare.undersampled_sources import UndersampledSources
from clerestory.scene.view import View

if TYPE_CHECKING:
    import xarray as xr

_UNITS = {quantity.name: quantity.unit for quantity in REPORTED}
_UNITS |= {f"{name}_error": unit for name, unit in _UNITS.items()}


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
    searches: dict[tuple[int, ...], SourceSearch] = {}

    def evaluated(
        pixels: EachImage | UncertainLuminance, shape: tuple[int, ...]
    ) -> tuple[Glare, UndersampledSources | None]:
        if shape not in searches:
            searches[shape] = SourceSearch(glare_view(view, shape[1], shape[0]), rules)
        given = replace(settings, given_illuminance=_at(illuminance, step))
        return evaluate_luminance(pixels, searches[shape], given)[1:]

    for step, picture in enumerate(_checked(luminance)):
        values = picture.value if isinstance(picture, UncertainLuminance) else picture
        if step == 0 and check_pixels:
            eye = glare_view(view, values.shape[1], values.shape[0])
            warn_if_coarse(eye, rules, name=name)
        errors = {}
        if isinstance(picture, UncertainLuminance):
            blocks = picture.of_blocks()
            result, poor = evaluated(blocks, blocks.value.shape)
            errors = {f"{key}_error": error for key, error in result.errors.items()}
            if blocks is not picture:
                result, _ = evaluated(values, values.shape)
        else:
            result, poor = evaluated(values, values.shape)
        results.append(result.values() | errors)
        if poor is not None:
            moment = f"picture {step}" if times is None else str(times[step])[:16]
            undersampled[moment] = poor
        if progress is not None:
            progress(step + 1)
    if undersampled:
        moment, worst = max(undersampled.items(), key=lambda item: item[1].share)
        warnings.warn(f"{name}, {moment}: {worst.words()}", ClerestoryWarning, 2)
    for what, given in (("times", times), ("illuminances", illuminance)):
        if given is not None:
            same_length(given, results, what, "pictures")
    require(results, "no pictures; at least one expected")
    return glare_dataset([results], times).squeeze("view", drop=True)


def _checked(
    luminance: Iterable[EachImage | UncertainLuminance],
) -> Iterator[EachImage | UncertainLuminance]:
    # Check each picture
    first = None
    for step, given in enumerate(luminance):
        picture = given.value if isinstance(given, UncertainLuminance) else given
        first = first or picture.shape
        require(
            picture.shape == first,
            f"picture {step} has {picture.shape[1]} × {picture.shape[0]} pixels;"
            f" {first[1]} × {first[0]} expected, as in the first picture",
        )
        require(
            picture.min() >= 0 and np.isfinite(picture.max()),
            f"picture {step} has negative or non-finite luminances; finite numbers of 0"
            " or more expected",
        )
        yield given


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
    """Return glare indices by name, of each step of each view, as a dataset.

    Without steps, all indices are empty.
    """
    steps = len(results[0])
    known = set().union(*(step for one in results for step in one))
    values = {
        name: np.array([[step.get(name, np.nan) for step in one] for one in results])
        for name in (known if steps else _UNITS)
    }
    return labelled_glare(values, np.arange(steps) if times is None else times)


def labelled_glare(
    values: Mapping[str, Float[np.ndarray, "view step"]], times: np.ndarray
) -> "xr.Dataset":
    """Return glare indices by name as a dataset; `times` may be numbers of steps."""
    axis = "time" if times.dtype.kind == "M" else "step"
    variables = {
        name: (("view", axis), values[name], {"units": unit})
        for name, unit in _UNITS.items()
        if name in values
    }
    # Imported here, since xarray loads slowly
    dataset: type[xr.Dataset] = importlib.import_module("xarray").Dataset
    return dataset(variables, coords={axis: times})
