"""Annual glare from a sequence of pictures of one view.

The pictures are evaluated one by one and need not be stored. Quantities that depend on
the view alone, such as solid angles and position indices, are computed once.
"""

import importlib
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np
from jaxtyping import Float

from clerestory.array_types import EachImage
from clerestory.checks import require, same_length
from clerestory.errors import ClerestoryWarning
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.glare_view import GlareView, glare_view
from clerestory.glare.index_settings import (
    EVALGLARE,
    Background,
    DgpCoefficients,
    IndexSettings,
)
from clerestory.glare.indices import REPORTED
from clerestory.glare.luminance_evaluation import PictureGlare, evaluate_together
from clerestory.glare.sources import SourceSearch, warn_if_coarse
from clerestory.glare.uncertainty import UncertainLuminance
from clerestory.glare.undersampled_sources import UndersampledSources
from clerestory.scene.view import View

if TYPE_CHECKING:
    import xarray as xr

# Most pictures that are evaluated together, and most pixels of them
_TOGETHER, _PIXELS = 16, 1 << 21

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
    settings = IndexSettings(background, None, low_light, None, coefficients)
    evaluated = _Evaluation(view, rules or SourceRules())
    results: list[Mapping[str, float]] = []
    undersampled: dict[str, UndersampledSources] = {}
    for pictures in _batches(_checked(luminance)):
        if not results and check_pixels:
            warn_if_coarse(evaluated.eye(pictures[0]), evaluated.rules, name=name)
        steps = range(len(results), len(results) + len(pictures))
        own = [replace(settings, given_illuminance=_at(illuminance, n)) for n in steps]
        for step, (values, poor) in zip(steps, evaluated(pictures, own), strict=True):
            results.append(values)
            if poor is not None:
                moment = f"picture {step}" if times is None else str(times[step])[:16]
                undersampled[moment] = poor
        if progress is not None:
            progress(len(results))
    if undersampled:
        moment, worst = max(undersampled.items(), key=lambda item: item[1].share)
        warnings.warn(f"{name}, {moment}: {worst.words()}", ClerestoryWarning, 2)
    for what, given in (("times", times), ("illuminances", illuminance)):
        if given is not None:
            same_length(given, results, what, "pictures")
    require(results, "no pictures; at least one expected")
    series = {key: np.array([each[key] for each in results]) for key in results[0]}
    dataset = glare_dataset(
        [series], np.arange(len(results)) if times is None else times
    )
    return dataset.squeeze("view", drop=True)


@dataclass(frozen=True, eq=False)
class _Evaluation:
    # Evaluation of pictures of one view, and of their blocks of pixels
    view: View
    rules: SourceRules
    _searches: dict[tuple[int, ...], SourceSearch] = field(default_factory=dict)

    def eye(self, picture: EachImage | UncertainLuminance) -> GlareView:
        """Return the pixel quantities of a picture."""
        rows, columns = _value(picture).shape
        return glare_view(self.view, columns, rows)

    def __call__(
        self,
        pictures: Sequence[EachImage | UncertainLuminance],
        settings: Sequence[IndexSettings],
    ) -> Iterator[tuple[Mapping[str, float], UndersampledSources | None]]:
        """Yield values and standard errors by name, and undersampled sources."""
        errors = self._glare(
            [
                picture.of_blocks()
                if isinstance(picture, UncertainLuminance)
                else picture
                for picture in pictures
            ],
            settings,
        )
        found = errors
        if any(
            isinstance(picture, UncertainLuminance) and picture.blocks is not None
            for picture in pictures
        ):
            found = self._glare([_value(picture) for picture in pictures], settings)
        for own, other in zip(found, errors, strict=True):
            named = {f"{name}_error": error for name, error in other.errors.items()}
            yield {**own.values, **named}, other.poor

    def _glare(
        self,
        pictures: Sequence[EachImage | UncertainLuminance],
        settings: Sequence[IndexSettings],
    ) -> list[PictureGlare]:
        eye = self.eye(pictures[0])
        search = self._searches.setdefault(eye.shape, SourceSearch(eye, self.rules))
        return evaluate_together(pictures, search, settings)


def _value(picture: EachImage | UncertainLuminance) -> EachImage:
    return picture.value if isinstance(picture, UncertainLuminance) else picture


def _batches(
    pictures: Iterator[EachImage | UncertainLuminance],
) -> Iterator[list[EachImage | UncertainLuminance]]:
    # Pictures that are evaluated together
    for first in pictures:
        most = max(1, min(_TOGETHER, _PIXELS // _value(first).size))
        yield [first, *islice(pictures, most - 1)]


def _checked(
    luminance: Iterable[EachImage | UncertainLuminance],
) -> Iterator[EachImage | UncertainLuminance]:
    # Check each picture
    first = None
    for step, given in enumerate(luminance):
        picture = _value(given)
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
    results: Sequence[Mapping[str, Float[np.ndarray, " step"]]], times: np.ndarray
) -> "xr.Dataset":
    """Return the glare indices of views, by name, as a dataset.

    `times` may be numbers of steps.
    """
    axis = "time" if times.dtype.kind == "M" else "step"
    variables = {
        name: (
            ("view", axis),
            np.array([one[name] for one in results]),
            {"units": unit},
        )
        for name, unit in _UNITS.items()
        if name in results[0]
    }
    # Imported here, since xarray loads slowly
    dataset: type[xr.Dataset] = importlib.import_module("xarray").Dataset
    return dataset(variables, coords={axis: times})
