"""Glare sources among directions with solid angles, at each of many time steps."""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, TypedDict, Unpack

import numpy as np
from jaxtyping import Float, Int

from clerestory.array_types import Values
from clerestory.glare.detection_criteria import SourceRules
from clerestory.glare.direction_groups import DirectionGroups
from clerestory.glare.eye_directions import (
    EyeDirections,
    SunDisc,
    directions_at,
    seen_by,
)
from clerestory.glare.position_index import PositionModel
from clerestory.glare.source_table import GlareSources
from clerestory.glare.sphere_samples import SphereSamples
from clerestory.scene.view import View

_NONE = np.zeros(0, dtype=np.int64)

# Time steps that are evaluated at once
_STEPS = 256


class _Parts(NamedTuple):
    # Parts of sources in blocks: source, step, and sums of solid angle, flux, and
    # moments of the flux
    source: Int[np.ndarray, " part"]
    step: Int[np.ndarray, " part"]
    sums: Float[np.ndarray, "5 part"]


class SourceOptions(TypedDict):
    """Options of the search for glare sources; see `direction_sources`."""

    sun: SunDisc
    threshold: Float[np.ndarray, " step"]
    rules: SourceRules
    model: PositionModel


def direction_sources(
    samples: SphereSamples,
    luminance: Float[np.ndarray, "direction step"],
    view: View,
    **options: Unpack[SourceOptions],
) -> GlareSources:
    """Return the glare sources of all time steps.

    Of the options, `threshold` is the luminance above which directions are bright
    [cd/m²].
    """
    nothing = GlareSources.of(luminance=[], solid_angle=[], position_index=[])
    blocks = _blocks(samples, luminance, view, **options)
    return GlareSources.joined([replace(nothing, steps=0), *blocks])


def _blocks(
    samples: SphereSamples,
    luminance: Float[np.ndarray, "direction step"],
    view: View,
    *,
    sun: SunDisc,
    threshold: Float[np.ndarray, " step"],
    rules: SourceRules,
    model: PositionModel,
) -> Iterator[GlareSources]:
    # Sources of all time steps, block by block
    field, peak = rules.field_of_view, rules.peak_luminance or np.inf
    eye = seen_by(view, samples.direction, model=model, field=field)
    disc = seen_by(view, sun.direction, model=model, field=field)
    visible = disc.searched & (sun.solid_angle > 0)
    ever = luminance.max(axis=1, initial=0) > threshold.min(initial=np.inf)
    some = np.flatnonzero(eye.searched & ever)
    direction, omega = samples.direction[some], samples.solid_angle[some]
    gap = rules.merge_angle / 2
    groups = DirectionGroups(direction, omega, gap)
    reach = np.cos(gap + np.sqrt(omega) / 2)[:, None]
    weights = np.stack([omega, *_moments(samples.solid_angle, eye)[:, some]])
    disc_flux = sun.luminance * sun.solid_angle
    of_disc = np.stack([sun.solid_angle, disc_flux, *_moments(disc_flux, disc)])
    for begin in range(0, luminance.shape[1], _STEPS):
        steps = np.arange(begin, min(begin + _STEPS, luminance.shape[1]))
        level = luminance[some, begin : begin + _STEPS]
        bright, every = level > threshold[steps], len(steps)
        shines = visible[steps] & (sun.luminance[steps] > threshold[steps])
        # Steps with sources
        lit_steps = np.flatnonzero(bright.any(axis=0) | shines)
        if len(lit_steps) < every:
            steps, shines = steps[lit_steps], shines[lit_steps]
            level, bright = level[:, lit_steps], bright[:, lit_steps]
        beam = sun.luminance[steps]
        high = bright & (level >= peak)
        near = shines & (direction @ sun.direction[steps].T > reach)

        # Sources without their peaks, then the peaks; parts of sources in each block
        found, first = [_Parts(_NONE, _NONE, np.zeros((5, 0)))], 0
        for members, counted, lit in (
            (bright, bright & ~high, shines & (beam < peak)),
            (high, high, shines & (beam >= peak)),
        ):
            if counted.any() or lit.any():
                group = first + groups.components(members, near)
                flux = groups.totals(weights, np.where(counted, level, 0))
                size = groups.totals(omega[None], counted)
                sums = np.concatenate([size, flux])
                disc_sums = (of_disc[:, steps] * lit)[:, None]
                sums = np.concatenate([sums, disc_sums], axis=1)
                block, step = np.nonzero(sums[0])
                source = group[block, step]
                found.append(_Parts(source, lit_steps[step], sums[:, block, step]))
                first = int(group.max()) + 1
        yield _block(found, every, view, model)


def _moments(flux: Values, eye: EyeDirections) -> Float[np.ndarray, "3 direction"]:
    # Illuminance at the eye, and flux times the place in a fisheye picture
    return np.asarray(flux * np.stack([eye.cosine, *eye.place.T]))


def _block(
    found: Sequence[_Parts], steps: int, view: View, model: PositionModel
) -> GlareSources:
    # Sources of all steps of a block
    source, step, sums = (
        np.concatenate(one, axis=-1) for one in zip(*found, strict=True)
    )
    used = np.bincount(source) > 0
    number = (np.cumsum(used) - 1)[source]
    of = np.zeros(np.count_nonzero(used), np.int64)
    of[number] = step
    omega, power, illuminance, *moments = (
        np.bincount(number, one).astype(float) for one in sums
    )

    # As in evalglare, the centre of a source is weighted by luminance and solid angle
    # in the coordinates of the picture
    place = np.stack(moments, axis=-1) / power[:, None]
    direction = directions_at(view, place)
    centre = seen_by(view, direction, model=model)
    right, up = place.T / np.pi
    none = np.zeros(omega.size)
    return GlareSources(
        luminance=power / omega,
        solid_angle=omega,
        position_index=centre.position_index,
        sigma=centre.sigma,
        direction=direction,
        illuminance=illuminance,
        pixels=none.astype(np.int64),
        row=0.5 - up,
        column=0.5 + right,
        zone=none.astype(np.int64),
        luminance_error=none,
        step=of,
        steps=steps,
    )
