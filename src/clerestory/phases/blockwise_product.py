"""Blockwise product of the matrix equation, with its statistical error.

The result is computed in blocks of receivers × time steps. Error components, the
deviations of the independent batches of each Monte Carlo estimate from their mean, are
multiplied by the same matrices as the estimate. The view matrices of all windows are
estimated from the same paths, so error components of equal index are summed over the
windows, and likewise those of C and C_d. All other estimates are statistically
independent.

Matrices are multiplied in the order that takes fewer operations: V (T D S) for many
receivers, (V T D) S for few receivers. With moving shades, V T D is computed for each
combination of shade states that occurs.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, field
from functools import cached_property, partial

import numpy as np
from jaxtyping import Float, Float32, Int

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.column_light import (
    Light,
    Received,
    SkyLight,
    SunLight,
    Weights,
    exiting_light,
)
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Readable,
    Skies,
    States,
    Term,
    WindowMatrices,
    chains,
    checked_states,
    require_columns,
)
from clerestory.phases.product_factors import Components, Factor, SunlightFactor
from clerestory.phases.received_sunlight import (
    Sunlit,
    received_sunlight,
)
from clerestory.phases.receivers import (
    SkyCoefficients,
    coefficients_cost_less,
    component_count,
    layers_of,
    light_bytes,
    shining_columns,
)
from clerestory.phases.recent_values import RecentValues
from clerestory.phases.stored_views import StoredColumns
from clerestory.sky.sky_product import lit_steps
from clerestory.threads import computed_in_threads

# Memory limits [bytes] of a block: exiting radiance with view matrices in memory and in
# files, and result
_LIGHT, _LIGHT_OF_FILES, _RECEIVED = 1 << 25, 1 << 29, 1 << 26

# Sky patches per time step of the smallest block: reading D then takes little of the
# time, and the exiting radiance takes a quarter of the memory of D
_PATCHES = 4


@dataclass(frozen=True, eq=False)
class Block:
    """Illuminance or radiance of a block of receivers in a block of time steps.

    Attributes
    ----------
    steps : indices of the time steps with light, counted from the start of `times`
    terms : illuminance or radiance of each term, with the sign of the term
    """

    rows: slice
    times: slice
    steps: Int[np.ndarray, " step"]
    terms: Float32[np.ndarray, "term out row step"]
    components: list[Components]


@dataclass(frozen=True, eq=False)
class BlockwiseProduct:
    """Matrix equation evaluated block by block.

    Attributes
    ----------
    states : index of the shade state at each time step, per window group; default 0
    weights : weights of the bands; one row for illuminance, one per band for pictures
    count : number of receivers (sensors or pixels)
    errors : whether to compute the components of standard errors as well
    summed : whether blocks have the sum of the terms in place of each of them
    most_receivers, most_steps : maximum block size; by default limited by memory
    recent : products D S that several products have in common
    threads : whether windows and blocks of receivers are computed in several threads
    """

    windows: Sequence[WindowMatrices]
    terms: Sequence[Term]
    skies: Skies
    states: States | None
    weights: Weights
    count: int
    errors: bool = True
    summed: bool = False
    most_receivers: int | None = None
    most_steps: int | None = None
    recent: RecentValues = field(default_factory=RecentValues)
    threads: bool = False

    def __post_init__(self) -> None:
        steps = len(self.skies.times)
        states = checked_states(self.windows, self.states, steps)
        object.__setattr__(self, "states", states)
        for term in self.terms:
            for chain in chains(self.windows, term.part):
                require_columns(term, chain, self.skies)

    def blocks(self) -> Iterator[Block]:
        """Yield all blocks, ordered by time steps, then by receivers."""
        parts = [self._chains(term) for term in self.terms]
        lit = _lit(self.skies)
        exiting = sum(light_bytes(found, self.weights.shape[1]) for found in parts)
        layers = sum(layers_of(found, errors=self.errors) for found in parts)
        stored = isinstance(parts[0][0].receiving[0], StoredColumns)
        light = _LIGHT_OF_FILES if stored else _LIGHT
        least = max(16, self.skies.whole.rows.size // _PATCHES)
        most = max(least, light // max(1, exiting))
        for times, inside in self._times(lit, most):
            factors = [
                factor
                for number, found in enumerate(parts)
                for factor in self._factors(number, found, inside)
            ]
            bytes_each = 4 * len(self.weights) * layers * max(1, len(inside))
            fits = max(16, _RECEIVED // bytes_each)
            own = partial(self._block, times, inside - times.start, factors)
            rows = _row_blocks(parts, self.count, self.most_receivers or fits)
            yield from (computed_in_threads if self.threads else map)(own, rows)

    @cached_property
    def _kinds(self) -> tuple[Int[np.ndarray, "kind window"], Int[np.ndarray, " time"]]:
        # Combinations of shade states, and the number of that of each time step
        states = np.array([np.asarray(state) for state in self.states or ()])
        kinds, number = np.unique(states, axis=1, return_inverse=True)
        return kinds.T, number.ravel()

    def _chains(self, term: Term) -> list[MatrixChain]:
        # Matrices of a term; or products V T D, whose states are the combinations of
        # shade states, if (V T D) S is faster
        found = chains(self.windows, term.part)
        kinds, number = self._kinds
        held = isinstance(found[0].receiving[0], TransferMatrix)
        if not (len(kinds) and held and found[0].factors):
            return found
        chosen = [
            [chain.at(int(state)) for chain, state in zip(found, kind, strict=True)]
            for kind in kinds
        ]
        products = tuple(SkyCoefficients(windows) for windows in chosen)
        alike = len(set(map(component_count, products))) == 1
        steps, outputs = np.bincount(number), len(self.weights)
        if alike and coefficients_cost_less(chosen, self.count, steps, outputs=outputs):
            return [MatrixChain(products)]
        return found

    def _times(
        self, lit: Int[np.ndarray, " lit"], most: int
    ) -> Iterator[tuple[slice, Int[np.ndarray, " step"]]]:
        # Blocks of `most_steps` time steps if given, else of `most` daylit time steps
        steps = len(self.skies.times)
        edges = [0, *lit[most::most].tolist()]
        if self.most_steps:
            edges = list(range(0, steps, self.most_steps))
        for first, last in zip(edges, [*edges[1:], steps], strict=True):
            yield slice(first, last), lit[(lit >= first) & (lit < last)]

    def _factors(
        self, number: int, found: list[MatrixChain], inside: Int[np.ndarray, " step"]
    ) -> Iterator[Factor | SunlightFactor]:
        term = self.terms[number]
        skies = self.skies.select(inside)
        every = np.arange(len(inside))
        states = [np.asarray(state)[inside] for state in self.states or ()]
        if isinstance(found[0].receiving[0], SkyCoefficients):
            states = [self._kinds[1][inside]]
        if found[0].factors:
            passed = exiting_light(
                found,
                skies.patches(term),
                states,
                self.weights,
                errors=self.errors,
                arriving=partial(self._arriving, term, inside),
                threads=self.threads,
            )
            views = [chain.view for chain in found]
            yield Factor((number, 0), term.sign, views, passed, every)
            return
        for window, chain in enumerate(found):
            several = len(chain.receiving) > 1
            for state, matrix in enumerate(chain.receiving):
                steps = np.flatnonzero(states[window] == state) if several else every
                source = number, len(chain.receiving) * window + state
                if len(steps) and isinstance(matrix, Sunlit):
                    assert skies.suns is not None
                    suns = skies.suns.select(steps)
                    product = received_sunlight(matrix, suns, self.weights)
                    lit = steps[product.steps]
                    yield SunlightFactor(source, term.sign, product, lit)
                elif len(steps) and not isinstance(matrix, Sunlit):
                    columns, light = self._direct(term, matrix, skies, steps)
                    yield Factor(source, term.sign, [columns], light, steps)

    def _arriving(
        self,
        term: Term,
        inside: Int[np.ndarray, " every"],
        daylight: TransferMatrix,
        steps: Int[np.ndarray, " step"],
        weights: Float[np.ndarray, "channel band"],
        make: Callable[[], Received],
    ) -> Received:
        # D S in the time steps `inside[steps]`
        key = (term.sky, inside[steps].tobytes(), weights.tobytes(), self.errors)
        of = (self.skies, daylight)
        return self.recent.value(key, make, size=lambda made: made.nbytes, of=of)

    def _direct(
        self,
        term: Term,
        matrix: Readable,
        skies: Skies,
        steps: Int[np.ndarray, " step"],
    ) -> tuple[Readable, Light]:
        # C and the sky radiance, or C_ds and the direct normal irradiance
        if term.part == "sun" and skies.suns is not None:
            columns, suns = shining_columns(matrix, skies.suns.select(steps))
            return columns, SunLight(suns, self.weights)
        return matrix, SkyLight(skies.patches(term).select(steps), self.weights)

    def _block(
        self,
        times: slice,
        steps: Int[np.ndarray, " step"],
        factors: Sequence[Factor | SunlightFactor],
        rows: slice,
    ) -> Block:
        terms = 1 if self.summed else len(self.terms)
        shape = terms, len(self.weights), rows.stop - rows.start, len(steps)
        total = np.zeros(shape, np.float32)
        components: dict[tuple[int, ...], Components] = {}
        for factor in factors:
            term = total[0 if self.summed else factor.source[0]]
            for part in factor.add(term, rows, errors=self.errors):
                key = *factor.paths, part.source[2], len(part.values)
                if key in components:
                    part = part.plus(components[key])
                components[key] = part
        return Block(rows, times, steps, total, list(components.values()))


def _lit(skies: Skies) -> Int[np.ndarray, " lit"]:
    # Indices of the time steps with light from the sky or the sun
    found = [lit_steps(sky.diffuse, sky.sun) for sky in (skies.whole, skies.sun) if sky]
    if skies.suns is not None:
        found.append(np.flatnonzero(np.diff(skies.suns.direct_normal.indptr)))
    return np.unique(np.concatenate(found))


def _row_blocks(
    parts: Sequence[Sequence[MatrixChain]], count: int, most: int
) -> list[slice]:
    # Blocks of receivers, each within one file of view matrices
    for found in parts:
        first = found[0].receiving[0]
        if isinstance(first, StoredColumns):
            return first.views.cut(most)
    return [slice(n, min(n + most, count)) for n in range(0, count, most)]
