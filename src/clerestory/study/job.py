"""Common inputs of all traced matrices of a study: scene, seeds, effort, cache."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from pathlib import Path
from typing import Any, Literal

from clerestory.engine.effort import Effort
from clerestory.engine.work_units import Executor, Local
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_store import BlockMaker, Store, block_names
from clerestory.phases.recent_values import RecentValues
from clerestory.progress import Progress
from clerestory.scene.model import Scene
from clerestory.scene.window import Window
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs

# Function that starts the progress display of a phase, given its name
Display = Callable[[str], Progress]

# Offsets added to the random seed for V_d and D_d, direct-sun coefficients, electric
# light, and daylight coefficients
DIRECT, SUN, LAMPS, COEFFICIENTS = 0x10000, 0x20000, 0x30000, 0x40000

# Offsets for view grids, and for the zones of a model of EnergyPlus
VIEW_GRIDS, ZONES = 0x400000, 0x500000

# Seed difference between consecutive shade states of a window
STATE = 0x100

# Default relative standard error, if a study gives neither samples nor relative_error
_RELATIVE_ERROR = 0.01


@dataclass(frozen=True, eq=False)
class Job:
    """Common inputs of all traced matrices of a study.

    `found` records which matrix files were in the cache. Results do not depend on the
    executor. The folder `scratch` is for hourly results that do not fit into memory.
    With `direct`, the job traces matrices of direct light (V_d, D_d, C_d). `recent` has
    values that variants of the study have in common. Matrices of all light have
    derivatives by the materials named in `derivatives`.
    """

    study: Study
    inputs: Inputs
    store: Store
    display: Display
    found: dict[str, bool] = field(default_factory=dict)
    executor: Executor = field(default_factory=Local)
    scratch: Path = Path()
    direct: bool = False
    recent: RecentValues = field(default_factory=RecentValues)
    derivatives: tuple[str, ...] = ()

    @property
    def differentiated(self) -> dict[str, Any]:
        """Keywords of tracing functions for derivatives; empty without them."""
        named = bool(self.derivatives) and not self.direct
        return {"derivatives": self.derivatives} if named else {}

    @property
    def prefix(self) -> str:
        """Prefix of matrix names: "direct-" for matrices of direct light."""
        return "direct-" if self.direct else ""

    @property
    def scene(self) -> Scene:
        """The room without its windows."""
        return self.inputs.scene

    @cached_property
    def scene_key(self) -> str:
        """Fingerprint of the scene."""
        return fingerprint(self.scene)

    @property
    def device(self) -> Literal["cpu", "cuda"]:
        """Compute device for tracing."""
        return self.executor.resolve(self.study.trace.device)

    def effort(self, stream: int = 0) -> Effort:
        """Return the sampling effort of a matrix; `stream` is added to the seed."""
        trace = self.study.trace
        error = None if trace.samples else trace.relative_error or _RELATIVE_ERROR
        return Effort(
            samples=trace.samples,
            relative_error=error,
            bounces=trace.bounces,
            seed=(trace.seed + stream + DIRECT * self.direct) % 2**32,
            device=self.device,
            executor=self.executor,
        )

    def pixel_effort(self, samples: int, stream: int = 0) -> Effort:
        """Return the sampling effort for a given number of ray paths per pixel."""
        return replace(self.effort(stream), samples=samples, relative_error=None)

    def direct_effort(self, stream: int, samples: int | None = None) -> Effort:
        """Return the sampling effort of direct light, without reflections."""
        effort = self.effort(stream)
        return replace(effort, samples=samples, relative_error=None, bounces=None)

    def matrix(
        self,
        name: str,
        trace: "partial[TransferMatrix]",
        effort: Effort,
        *,
        shown: str = "",
    ) -> TransferMatrix:
        """Return a matrix from the cache, or trace and store it.

        `trace` is a function of `effort` and `progress` that traces the matrix. The
        progress display has the title `shown`, by default `name`.
        """
        name, title = self.prefix + name, self.prefix + (shown or name)

        def make() -> dict[str, TransferMatrix]:
            return {name: trace(effort=effort, progress=self.display(title))}

        return self._cached([name], self._key(trace, effort), make)[name]

    def pair(
        self,
        names: tuple[str, str],
        trace: "partial[tuple[TransferMatrix, TransferMatrix]]",
        effort: Effort,
        *,
        shown: str,
    ) -> tuple[TransferMatrix, TransferMatrix]:
        """Return two matrices that are traced together; see `matrix`."""

        def make() -> dict[str, TransferMatrix]:
            traced = trace(effort=effort, progress=self.display(shown))
            return dict(zip(names, traced, strict=True))

        found = self._cached(list(names), self._key(trace, effort), make)
        return found[names[0]], found[names[1]]

    def matrices(
        self,
        name: str,
        windows: Sequence[Window],
        trace: "partial[dict[str, TransferMatrix]]",
        effort: Effort,
        *,
        shown: str,
    ) -> dict[str, TransferMatrix]:
        """Return matrices that are traced together, by window name; see `matrix`.

        A matrix in the cache is named `name`, followed by the name of the window.
        """
        names = {f"{self.prefix}{name}-{each.name}": each.name for each in windows}

        def make() -> dict[str, TransferMatrix]:
            traced = trace(effort=effort, progress=self.display(self.prefix + shown))
            return {name: traced[window] for name, window in names.items()}

        found = self._cached(list(names), self._key(trace, effort), make)
        return {window: found[name] for name, window in names.items()}

    def _key(self, trace: "partial[Any]", effort: Effort) -> str:
        # Fingerprint of tracing function and inputs; the scene is fingerprinted once
        inputs = [*trace.args, *trace.keywords.values()]
        known = [self.scene_key if each is self.scene else each for each in inputs]
        return fingerprint(trace.func.__name__, known, list(trace.keywords), effort)

    def _cached(
        self, names: list[str], key: str, make: Callable[[], dict[str, TransferMatrix]]
    ) -> dict[str, TransferMatrix]:
        for name in names:
            file = self.store.path(name, key).name
            self.found.setdefault(file, self.store.holds(name, key))
        return self.store.matrices(names, key, make)

    def blocks(
        self, name: str, key: str, rows: Sequence[slice], make: BlockMaker
    ) -> tuple[Path, ...]:
        """Return the block files of a large stored matrix; trace missing blocks."""
        kept = [self.store.holds(n, key) for n in block_names(name, len(rows))]
        self.found.setdefault(self.store.path(name, key).name, all(kept))
        return self.store.blocks(name, key, rows, make)
