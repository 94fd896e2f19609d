"""Evaluation of the luminance of pictures: glare sources, indices, standard errors.

The indices of many pictures of a view are computed together, since the formulas take
much longer to call than to evaluate.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice

import numpy as np

from clerestory.array_types import Image, Pictures
from clerestory.glare.index import EyePhotometry
from clerestory.glare.index_settings import IndexSettings
from clerestory.glare.indices import Glare, quantities_over_time
from clerestory.glare.sources import (
    Members,
    SourceSearch,
    reference_luminance,
    source_table,
)
from clerestory.glare.uncertainty import UncertainLuminance, index_errors
from clerestory.glare.undersampled_sources import (
    UndersampledSources,
    undersampled_sources,
    without_undersampled,
)
from clerestory.glare.zones import Zones, cut_along
from clerestory.scene.view import View


@dataclass(frozen=True, eq=False)
class PictureGlare:
    """Glare of one picture: source pixels, values and standard errors of the indices.

    `poor` are the undersampled sources, if they have an appreciable share of DGP.
    """

    members: Members
    eye: EyePhotometry
    values: Mapping[str, float]
    errors: Mapping[str, float]
    poor: UndersampledSources | None = None


def evaluate_luminance(
    luminance: Image | UncertainLuminance,
    search: SourceSearch,
    settings: IndexSettings,
    *,
    zones: Zones | None = None,
) -> tuple[Members, Glare, UndersampledSources | None]:
    """Return source pixels, glare indices with standard errors, and poor sources."""
    [found] = evaluate_together([luminance], search, [settings], zones=zones)
    return found.members, Glare(found.eye, found.errors), found.poor


def evaluate_together(
    pictures: Sequence[Image | UncertainLuminance],
    search: SourceSearch,
    settings: Sequence[IndexSettings],
    *,
    zones: Zones | None = None,
) -> list[PictureGlare]:
    """Return the glare of pictures of one view, whose indices are computed together.

    The settings of the pictures differ in the given illuminance only.
    """
    parts = [
        _Parts.of(picture, search, own, zones)
        for picture, own in zip(pictures, settings, strict=True)
    ]
    every = [eye for part in parts for eye in part.eyes]
    quantities = quantities_over_time(EyePhotometry.joined(every))
    edges = np.cumsum([len(eye.average) for eye in every])
    columns = iter(np.split(np.stack(list(quantities.values())), edges[:-1], axis=1))
    names, view = tuple(quantities), search.eye.view
    return [
        part.glare(names, list(islice(columns, len(part.eyes))), view) for part in parts
    ]


@dataclass(frozen=True, eq=False)
class _Parts:
    # Source pixels and photometry of a picture, then of its draws of errors, if known,
    # and last of the picture without undersampled sources, if there are any

    members: Members
    eyes: Sequence[EyePhotometry]

    @classmethod
    def of(
        cls,
        luminance: Image | UncertainLuminance,
        search: SourceSearch,
        settings: IndexSettings,
        zones: Zones | None,
    ) -> "_Parts":
        evaluated = partial(photometry, search=search, settings=settings, zones=zones)
        if not isinstance(luminance, UncertainLuminance):
            members, eye = evaluated(luminance[None])
            return cls(members, (eye,))
        members, eye = evaluated(luminance.value[None], error=luminance.error)
        _, drawn = evaluated(luminance.pairs())
        reduced = without_undersampled(luminance, search.eye, members)
        if reduced is None:
            return cls(members, (eye, drawn))
        return cls(members, (eye, drawn, evaluated(reduced[None])[1]))

    def glare(
        self, names: Sequence[str], values: Sequence[np.ndarray], view: View
    ) -> PictureGlare:
        """Return the glare; `values` are those of all quantities and `eyes`."""
        eye, [own, *rest] = self.eyes[0], values
        known = dict(zip(names, own[:, 0].tolist(), strict=True))
        if not rest:
            return PictureGlare(self.members, eye, known, {})
        error = index_errors(rest[0])
        if len(rest) > 1:
            # The error covers the value without undersampled sources
            error = np.maximum(error, abs(own - rest[1])[:, 0])
        errors = dict(zip(names, error.tolist(), strict=True))
        poor = None
        if len(rest) > 1:
            without = float(rest[1][names.index("dgp"), 0])
            poor = undersampled_sources(Glare(eye, errors), without, view)
        return PictureGlare(self.members, eye, known, errors, poor)


def photometry(
    pictures: Pictures,
    search: SourceSearch,
    settings: IndexSettings,
    *,
    zones: Zones | None = None,
    error: Image | None = None,
) -> tuple[Members, EyePhotometry]:
    """Return the pixels of glare sources, and the photometry of pictures.

    `error` is the independent standard error of each pixel [cd/m²].
    """
    eye, task, zone_of = search.eye, search.rules.task, None
    members, own = search.members(pictures)
    divided = members
    if zones is not None:
        divided, zone_of = cut_along(members, zones.of_pixels(eye))
    sources = source_table(divided, own, pictures, eye, zone=zone_of, error=error)
    average = reference = eye.flux(pictures) / eye.total_solid_angle
    if task:
        reference = np.array([reference_luminance(p, eye, task) for p in pictures])
    illuminance, given = eye.illuminance(pictures), settings.given_illuminance
    return members, EyePhotometry(
        sources=sources.larger_than(search.rules.smallest),
        illuminance=illuminance,
        average=average,
        reference=reference,
        brightest=(pictures * eye.valid).max(axis=(1, 2)).astype(float),
        eye_illuminance=illuminance if given is None else np.full_like(average, given),
        solid_angle=eye.total_solid_angle,
        settings=settings,
    )
