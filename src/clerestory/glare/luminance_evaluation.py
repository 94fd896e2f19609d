"""Evaluation of the luminance of pictures: glare sources, indices, standard errors.

The indices of many pictures of a view are computed together, since the formulas take
much longer to call than to evaluate.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import islice

import numpy as np

from clerestory.array_types import EachGroup, Image, Pictures
from clerestory.glare.index import EyePhotometry
from clerestory.glare.index_settings import IndexSettings
from clerestory.glare.indices import Glare, quantities_over_time
from clerestory.glare.picture_sources import source_table
from clerestory.glare.sources import (
    Members,
    OwnMembers,
    SourceSearch,
    reference_luminance,
)
from clerestory.glare.uncertainty import UncertainLuminance, index_errors
from clerestory.glare.undersampled_sources import (
    UndersampledSources,
    undersampled_sources,
    without_undersampled,
)
from clerestory.glare.zones import Zones, cut_along
from clerestory.scene.view import View

# Pixels of the sources of a group of pictures, and those that each picture has
Found = tuple[Members, OwnMembers]


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
    groups: list[EachGroup] = []
    for picture in pictures:
        if isinstance(picture, UncertainLuminance):
            groups += [picture.value[None], picture.pairs()]
        else:
            groups.append(picture[None])
    found = zip(groups, search.members(groups), strict=True)
    how = (_Photometry(search, own, zones) for own in settings)
    parts = [_Parts.of(*each, found) for each in zip(pictures, how, strict=True)]
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
        photometry: "_Photometry",
        found: Iterator[tuple[EachGroup, Found]],
    ) -> "_Parts":
        """Return the parts of a picture; take its pictures from those found."""
        pictures, own = next(found)
        members = own[0]
        if not isinstance(luminance, UncertainLuminance):
            return cls(members, (photometry.of(pictures, own),))
        eyes = [
            photometry.of(pictures, own, luminance.error),
            photometry.of(*next(found)),
        ]
        search = photometry.search
        reduced = without_undersampled(luminance, search.eye, members)
        if reduced is not None:
            group = reduced[None]
            [own] = search.members([group])
            eyes.append(photometry.of(group, own))
        return cls(members, eyes)

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


@dataclass(frozen=True, eq=False)
class _Photometry:
    # Photometry of pictures of one view
    search: SourceSearch
    settings: IndexSettings
    zones: Zones | None

    def of(
        self, pictures: Pictures, found: Found, error: Image | None = None
    ) -> EyePhotometry:
        """Return the photometry of pictures whose source pixels are found.

        `error` is the independent standard error of each pixel [cd/m²].
        """
        eye, rules, zone_of = self.search.eye, self.search.rules, None
        members, own = found
        if self.zones is not None:
            members, zone_of = cut_along(members, self.zones.of_pixels(eye))
        sources = source_table(members, own, pictures, eye, zone=zone_of, error=error)
        average = reference = eye.flux(pictures) / eye.total_solid_angle
        if rules.task:
            each = (reference_luminance(one, eye, rules.task) for one in pictures)
            reference = np.array(list(each))
        level, given = eye.illuminance(pictures), self.settings.given_illuminance
        return EyePhotometry(
            sources=sources.larger_than(rules.smallest),
            illuminance=level,
            average=average,
            reference=reference,
            brightest=(pictures * eye.valid).max(axis=(1, 2)).astype(float),
            eye_illuminance=level if given is None else np.full_like(level, given),
            solid_angle=eye.total_solid_angle,
            settings=self.settings,
        )
