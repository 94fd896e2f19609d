"""Stacks of layers as tensor trees, by random walks between the layers.

Klems patches, about ten degrees wide, are too coarse for the sunlight that blinds and
films transmit. Each random walk starts in a direction within an incident cell, is
transmitted or reflected at each layer, and is scored in the exit cell. Independent
batches give standard errors.

Reference: L. O. Grobe, Buildings 7 (1), 22, 2017 (layers at high resolution).
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np
from jaxtyping import Float

from clerestory.array_types import Directions, Indices, Mask, Values
from clerestory.brief_repr import brief
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.resample import full_tree
from clerestory.bsdf.scattering_function import OF_SIDE, Function, ScatteringFunction
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.checks import one_of, require, within
from clerestory.glazing.layer import Layer
from clerestory.glazing.scatterer import Scatterer, scatterer
from clerestory.glazing.standard import CHANNELS, Channel, Standard, nfrc
from clerestory.hemisphere.shirley_chiu import directions_from_square, square_from_disc
from clerestory.progress import Progress

# Largest parameter `halvings`: (2⁶)⁴ = 17 million cells before tree reduction.
_FINEST = 6

# Number of simultaneous walks, and weight below which Russian roulette applies.
_TOGETHER = 1 << 18
_FAINT = 0.05


@final
@dataclass(frozen=True, eq=False)
class WalkedLayers:
    """Optical properties of a stack of layers: tensor trees of rank 4.

    `diffuse` has the diffuse transmittance or reflectance and its standard error, per
    channel and function.
    """

    bsdf: Bsdf
    diffuse: dict[tuple[Channel, Function], tuple[float, float]]

    __repr__ = brief


def walk_layers(
    layers: Sequence[Layer],
    *,
    halvings: int = 5,
    walkers: int = 256,
    batches: int = 8,
    seed: int = 1,
    channels: Sequence[Channel] = CHANNELS,
    standard: Standard | None = None,
    name: str = "",
    report: Progress = lambda _share, _note: None,
) -> WalkedLayers:
    """Return the optical properties of a stack of layers as tensor trees.

    Each band is computed separately, from band averages of the layers.

    Parameters
    ----------
    layers : layers from outdoors to indoors, at least one
    halvings : h for 2^h cells along each axis of the tensor tree, at most 6
    walkers : number of random walks per incident cell, side and channel, in all batches
    batches : number of independent batches, at least 2
    seed : seed of the random numbers; results are bitwise reproducible
    channels : "solar", "visible" or both
    standard : standard of the spectral averages; default: NFRC
    report : function called with the completed fraction and the channel

    Raises
    ------
    InputError : no layers, or numbers out of range

    Examples
    --------
    >>> from clerestory.glazing.layer import Diffuser
    >>> from clerestory.glazing.pane import grey_pane
    >>> cloth = Diffuser(grey_pane(0.5, 0.2))
    >>> pair = walk_layers([cloth, cloth], halvings=1, walkers=4096, seed=3)
    >>> share, error = pair.diffuse["visible", "transmission_front"]
    >>> abs(share - 0.25 / 0.96) < 4 * error < 0.02
    True
    """
    require(layers, "no layers; at least one expected")
    within(halvings, "halvings", least=0, most=_FINEST)
    require(batches >= 2, f"batches is {batches}; 2 or more expected")
    require(walkers >= batches, f"walkers is {walkers}; one or more per batch expected")
    for channel in channels:
        one_of(channel, "channel", choices=CHANNELS)
    standard = standard or nfrc()
    functions: dict[tuple[str, Function], ScatteringFunction] = {}
    diffuse: dict[tuple[Channel, Function], tuple[float, float]] = {}
    seeds = np.random.SeedSequence(seed).spawn(2 * len(channels))
    for number, channel in enumerate(channels):
        met = [scatterer(layer, standard, channel) for layer in layers]
        for back in (False, True):
            plan = _Plan(met, halvings, walkers // batches, back)
            part = 2 * number + back
            tallies = [
                _tally(plan, np.random.default_rng(child))
                for child in seeds[part].spawn(batches)
            ]
            for row, function in enumerate(OF_SIDE["back" if back else "front"]):
                counts = [tally[row] for tally in tallies]
                functions[channel, function] = _tree(counts, halvings)
                diffuse[channel, function] = _diffuse(counts, halvings)
            report((part + 1) / (2 * len(channels)), f"{channel}")
    product = Product(
        name=name or " | ".join(layer.name for layer in layers),
        manufacturer="stack of layers",
        thickness=sum(layer.thickness for layer in layers),
    )
    return WalkedLayers(Bsdf(functions, product), diffuse)


@dataclass(frozen=True, eq=False)
class _Plan:
    # Parameters of all batches of one incident side and channel
    met: list[Scatterer]
    halvings: int
    walkers: int
    back: bool

    @property
    def cells(self) -> int:
        return 1 << 2 * self.halvings


def _tally(
    plan: _Plan, rng: np.random.Generator
) -> Float[np.ndarray, "2 incident leaving"]:
    # Transmitted and reflected flux per walk, by incident and exit cell
    size = plan.cells * plan.cells
    sums = np.zeros((2, size))
    step = max(1, _TOGETHER // plan.walkers)
    for start in range(0, plan.cells, step):
        several = np.arange(start, min(start + step, plan.cells))
        cell = np.repeat(several, plan.walkers)
        travel, weight, passed = _walk(plan.met, _start(cell, plan, rng), rng)
        place = cell * plan.cells + _cell(travel, plan.halvings)
        for row, some in enumerate((passed, ~passed)):
            sums[row] += np.bincount(place[some], weight[some], minlength=size)
    return np.asarray((sums / plan.walkers).reshape(2, plan.cells, plan.cells))


def _start(cell: Indices, plan: _Plan, rng: np.random.Generator) -> Directions:
    # Random directions of travel, uniform in projected solid angle within each cell
    wide = 1 << plan.halvings
    inside = rng.random((2, len(cell)))
    travel = directions_from_square(
        (cell // wide + inside[0]) / wide, (cell % wide + inside[1]) / wide
    )
    travel[:, 2] = np.maximum(travel[:, 2], 1e-6)
    return travel * [1, 1, -1 if plan.back else 1]


def _walk(
    met: Sequence[Scatterer], travel: Directions, rng: np.random.Generator
) -> tuple[Directions, Values, Mask]:
    """Return exit direction and weight of each walk, and whether it was transmitted."""
    into_room = bool(travel[0, 2] > 0)
    weight = np.ones(len(travel))
    ahead = np.full(len(travel), 0 if into_room else len(met) - 1)
    active = np.ones(len(travel), bool)
    while np.any(active):
        # Scatter the walks that arrive at each layer, separately for both sides
        for number, layer in enumerate(met):
            for forward in (True, False):
                here = active & (ahead == number) & ((travel[:, 2] > 0) == forward)
                some = np.flatnonzero(here)
                if not len(some):
                    continue
                on, back = layer.shares(travel[some])
                total = on + back
                passed = rng.random(len(some)) * total < on
                weight[some] *= total
                travel[some] = layer.leave(travel[some], passed, rng)
                ahead[some] = np.where(travel[some, 2] > 0, number + 1, number - 1)
                active[some] = total > 0

        # Walks beyond the first or last layer are finished; the remaining walks are
        # subject to Russian roulette
        active &= (ahead >= 0) & (ahead < len(met))
        faint = active & (weight < _FAINT)
        survive = rng.random(int(faint.sum())) < 0.5
        weight[faint] *= np.where(survive, 2, 0)
        active[faint] = survive
    return travel, weight, (ahead >= len(met)) == into_room


def _cell(travel: Directions, halvings: int) -> Indices:
    wide = 1 << halvings
    a, b = square_from_disc(travel[:, 0], travel[:, 1])
    place = np.minimum((np.stack([a, b]) * wide).astype(int), wide - 1)
    return np.asarray(place[0] * wide + place[1])


def _tree(
    counts: Sequence[Float[np.ndarray, "incident leaving"]], halvings: int
) -> ScatteringTree:
    area = np.pi * 0.25**halvings
    batches = len(counts)
    mean = sum(counts) / batches
    spread = sum((count - mean) ** 2 for count in counts) / (batches - 1) / batches
    error = full_tree(np.sqrt(spread) / area, halvings)
    tree = full_tree(np.asarray(mean / area), halvings)
    return ScatteringTree(tree.slots, tree.rank, tree.depth, standard_error=error)


def _diffuse(
    counts: Sequence[Float[np.ndarray, "incident leaving"]], halvings: int
) -> tuple[float, float]:
    shares = np.array([count.sum() / 4**halvings for count in counts])
    return float(shares.mean()), float(shares.std(ddof=1) / np.sqrt(len(shares)))
