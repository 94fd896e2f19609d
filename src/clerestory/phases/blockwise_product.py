"""Blockwise product of the matrix equation, with its error components.

Blocks of receivers × blocks of time steps. Error components, the deviations of the
independent batches of each estimate, pass through the product like the values. View
matrices of all windows are scored by the same paths: their components are added over
the windows, number by number. All other estimates are independent of each other.

The order of the factors is chosen by cost: V (T D S) for many receivers and for shades
that move, (V T D) S for few receivers.
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float32, Int

from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.column_light import (
    Light,
    SkyLight,
    SunLight,
    Weights,
    exiting_light,
)
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Readable,
    Receiving,
    Skies,
    States,
    Term,
    WindowMatrices,
    chains,
    checked_states,
    require_columns,
)
from clerestory.phases.receivers import (
    SkyCoefficients,
    chain_components,
    coefficients_cost_less,
    component_count,
    readable,
    shining_columns,
    side_by_side,
)
from clerestory.phases.stored_views import StoredColumns
from clerestory.sky.sky_product import lit_steps

# Largest arrays of exiting light, with view matrices in memory and in files, which are
# read anew for every block of steps, and of what a block of receivers gets [bytes]
_LIGHT, _LIGHT_OF_FILES, _RECEIVED = 1 << 27, 1 << 29, 1 << 26


@dataclass(frozen=True, eq=False)
class Components:
    """Error components of some receivers, of one independent estimate.

    Attributes
    ----------
    source : which estimate: the same in all blocks
    steps : places among the steps of the block
    values : in the sign of their term
    """

    source: tuple[int, int, int]
    steps: Int[np.ndarray, " step"]
    values: Float32[np.ndarray, "component out row step"]


@dataclass(frozen=True, eq=False)
class Block:
    """Light of some receivers in some time steps.

    Attributes
    ----------
    rows : the receivers
    times : consecutive time steps
    steps : places of those with light among them
    terms : of the equation, in their signs
    """

    rows: slice
    times: slice
    steps: Int[np.ndarray, " step"]
    terms: Float32[np.ndarray, "term out row step"]
    components: list[Components]


@dataclass(frozen=True, eq=False)
class _Factor:
    # Receiving matrices side by side, and the light of their columns in some steps.
    # `views` tells that the columns are window patches: components of V come first
    source: tuple[int, int]
    sign: int
    matrices: Sequence[TransferMatrix | Readable]
    light: Light
    steps: Int[np.ndarray, " step"]

    def received(
        self, rows: slice, *, errors: bool
    ) -> tuple[np.ndarray, list[Components]]:
        layers = side_by_side(self.matrices, rows, errors=errors)
        found = self.light.received(layers)
        groups = [found[1:], *(self.light.spread(layers[0]) if errors else ())]
        if self.sign < 0:
            for values in (found, *groups[1:]):
                np.negative(values, out=values)
        parts = [
            Components((*self.source, number), self.steps, values)
            for number, values in enumerate(groups)
            if len(values)
        ]
        return found[0], parts


@dataclass(frozen=True, eq=False)
class BlockwiseProduct:
    """A matrix equation that is multiplied out block by block.

    Attributes
    ----------
    terms : of the equation
    states : number of the state at each step, per window; by default the first
    weights : of the bands; one row for illuminance, one for each band of a picture
    count : number of receivers
    errors : whether error components are carried along
    most_receivers, most_steps : in a block; by default what memory allows

    Raises
    ------
    MatrixError : matrices do not fit each other, or states that do not exist
    """

    windows: Sequence[WindowMatrices]
    terms: Sequence[Term]
    skies: Skies
    states: States | None
    weights: Weights
    count: int
    errors: bool = True
    most_receivers: int | None = None
    most_steps: int | None = None

    def __post_init__(self) -> None:
        steps = len(self.skies.times)
        states = checked_states(self.windows, self.states, steps)
        object.__setattr__(self, "states", states)
        for term in self.terms:
            for chain in chains(self.windows, term.part):
                require_columns(term, chain, self.skies)

    def blocks(self) -> Iterator[Block]:
        """Yield the light of all receivers: block of steps after block of steps."""
        parts = [self._chains(term) for term in self.terms]
        lit = _lit(self.skies)
        exiting = sum(_light_bytes(found, self.weights) for found in parts)
        layers = sum(_layers(found, errors=self.errors) for found in parts)
        stored = isinstance(parts[0][0].receiving[0], StoredColumns)
        light = _LIGHT_OF_FILES if stored else _LIGHT
        most = max(16, light // max(1, exiting))
        for times, inside in self._times(lit, most):
            factors = [
                factor
                for number, (term, found) in enumerate(
                    zip(self.terms, parts, strict=True)
                )
                for factor in self._factors(number, term, found, inside)
            ]
            bytes_each = 4 * len(self.weights) * layers * max(1, len(inside))
            fits = max(16, _RECEIVED // bytes_each)
            for rows in _row_blocks(parts, self.count, self.most_receivers or fits):
                yield self._block(rows, times, inside - times.start, factors)

    def _chains(self, term: Term) -> list[MatrixChain]:
        # The matrices of a term; coefficients V T D where they take less time
        found = chains(self.windows, term.part)
        states = self.states or ()
        fixed = all(len(s) and (s == s[0]).all() for s in states)
        held = isinstance(found[0].receiving[0], TransferMatrix)
        if not (fixed and held and found[0].factors):
            return found
        chosen = [chain.at(int(s[0])) for chain, s in zip(found, states, strict=True)]
        if coefficients_cost_less(chosen, self.count, len(self.skies.times)):
            return [MatrixChain((SkyCoefficients(chosen),))]
        return found

    def _times(
        self, lit: Int[np.ndarray, " lit"], most: int
    ) -> Iterator[tuple[slice, Int[np.ndarray, " step"]]]:
        # Consecutive steps: so many of them, or so many with light
        steps = len(self.skies.times)
        edges = [0, *lit[most::most].tolist()]
        if self.most_steps:
            edges = list(range(0, steps, self.most_steps))
        for first, last in zip(edges, [*edges[1:], steps], strict=True):
            yield slice(first, last), lit[(lit >= first) & (lit < last)]

    def _factors(
        self,
        number: int,
        term: Term,
        found: list[MatrixChain],
        inside: Int[np.ndarray, " step"],
    ) -> Iterator[_Factor]:
        skies = self.skies.select(inside)
        every = np.arange(len(inside))
        states = [np.asarray(state)[inside] for state in self.states or ()]
        if found[0].factors:
            sky = skies.patches(term)
            light = exiting_light(found, sky, states, self.weights, errors=self.errors)
            views = [readable(chain.receiving[0]) for chain in found]
            yield _Factor((number, 0), term.sign, views, light, every)
            return
        for window, chain in enumerate(found):
            several = len(chain.receiving) > 1
            for state, matrix in enumerate(chain.receiving):
                steps = np.flatnonzero(states[window] == state) if several else every
                source = number, len(chain.receiving) * window + state
                if len(steps):
                    yield self._direct(source, term, matrix, skies, steps)

    def _direct(
        self,
        source: tuple[int, int],
        term: Term,
        matrix: Receiving,
        skies: Skies,
        steps: Int[np.ndarray, " step"],
    ) -> _Factor:
        # A matrix that leads from the receivers to the sky, or to the suns
        if term.part != "sun" or skies.suns is None:
            sky = skies.patches(term).select(steps)
            light = SkyLight(sky, self.weights)
            return _Factor(source, term.sign, [readable(matrix)], light, steps)
        columns, normal = shining_columns(matrix, skies.suns.direct_normal[:, steps])
        sun = SunLight(normal, self.weights)
        return _Factor(source, term.sign, [columns], sun, steps)

    def _block(
        self,
        rows: slice,
        times: slice,
        steps: Int[np.ndarray, " step"],
        factors: Sequence[_Factor],
    ) -> Block:
        size = rows.stop - rows.start
        shape = len(self.terms), len(self.weights), size, len(steps)
        total, components = np.zeros(shape, np.float32), []
        for factor in factors:
            values, parts = factor.received(rows, errors=self.errors)
            if len(factor.steps) == len(steps):
                total[factor.source[0]] += values
            else:
                total[factor.source[0]][..., factor.steps] += values
            components += parts
        return Block(rows, times, steps, total, components)


def _lit(skies: Skies) -> Int[np.ndarray, " lit"]:
    # Steps with light in any of the skies
    found = [lit_steps(sky.diffuse, sky.sun) for sky in (skies.whole, skies.sun) if sky]
    if skies.suns is not None:
        found.append(np.flatnonzero(np.diff(skies.suns.direct_normal.indptr)))
    return np.unique(np.concatenate(found))


def _row_blocks(
    parts: Sequence[Sequence[MatrixChain]], count: int, most: int
) -> list[slice]:
    # Rows of files are read file by file
    for found in parts:
        first = found[0].receiving[0]
        if isinstance(first, StoredColumns):
            return first.views.cut(most)
    return [slice(n, min(n + most, count)) for n in range(0, count, most)]


def _layers(found: Sequence[MatrixChain], *, errors: bool) -> int:
    # Value and error components of what one receiver gets
    if not errors:
        return 1
    views = max(component_count(m) for chain in found for m in chain.receiving)
    return 1 + views + sum(chain_components(chain) for chain in found)


def _light_bytes(found: Sequence[MatrixChain], weights: Weights) -> int:
    # Exiting light of one step
    patches = sum(
        chain.factors[0][0].rows.size * (1 + chain_components(chain))
        for chain in found
        if chain.factors
    )
    return int(4 * patches * weights.shape[1])
