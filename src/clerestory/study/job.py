"""What every matrix of a study needs: scene, seeds, effort, and where it is kept."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path
from typing import Literal

from clerestory.engine.effort import Effort
from clerestory.engine.work_units import Executor, Local
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_store import Store, block_names
from clerestory.progress import Progress
from clerestory.scene.model import Scene
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs

# Starts the display of one phase, given its name
Display = Callable[[str], Progress]

# Random numbers of the direct phases, of the suns, of lamps and of the two-phase
# method, apart from those of V and D
DIRECT, SUN, LAMPS, COEFFICIENTS = 0x10000, 0x20000, 0x30000, 0x40000

# Apart the states of one window
STATE = 0x100

# Aimed at where a study asks for neither samples nor an error
_RELATIVE_ERROR = 0.01


@dataclass(frozen=True, eq=False)
class Job:
    """What every matrix of a study needs.

    Attributes
    ----------
    found : whether each matrix was found in the store, by its file's name; grows
        while the study is traced
    executor : does the work; it changes no bit of the results
    scratch : folder for hourly results that memory does not hold
    """

    study: Study
    inputs: Inputs
    store: Store
    display: Display
    found: dict[str, bool] = field(default_factory=dict)
    executor: Executor = field(default_factory=Local)
    scratch: Path = Path()

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
        """The device that is used."""
        return self.executor.resolve(self.study.trace.device)

    def seed(self, stream: int = 0) -> int:
        """Random numbers of one matrix, apart from those of the others."""
        return (self.study.trace.seed + stream) % 2**32

    def effort(self, stream: int = 0) -> Effort:
        """How long to trace, where, and with which random numbers."""
        trace = self.study.trace
        error = None if trace.samples else trace.relative_error or _RELATIVE_ERROR
        return Effort(
            samples=trace.samples,
            relative_error=error,
            bounces=trace.bounces,
            seed=self.seed(stream),
            device=self.device,
            executor=self.executor,
        )

    def pixel_effort(self, samples: int, stream: int = 0) -> Effort:
        """Effort of so many paths a pixel."""
        return replace(self.effort(stream), samples=samples, relative_error=None)

    def direct_effort(self, stream: int, samples: int | None = None) -> Effort:
        """Effort of direct light, which has no bounces."""
        return Effort(
            samples=samples,
            seed=self.seed(stream),
            device=self.device,
            executor=self.executor,
        )

    def matrix(
        self, name: str, key: str, make: Callable[[], TransferMatrix]
    ) -> TransferMatrix:
        """Return a matrix of an earlier run, or make and keep it."""
        return self.matrices([name], key, lambda: {name: make()})[name]

    def matrices(
        self,
        names: list[str],
        key: str,
        make: Callable[[], Mapping[str, TransferMatrix]],
    ) -> dict[str, TransferMatrix]:
        """Return matrices that are traced together, of an earlier run or just made."""
        for name in names:
            file = self.store.path(name, key).name
            self.found.setdefault(file, self.store.holds(name, key))
        return self.store.matrices(names, key, make)

    def blocks(
        self,
        name: str,
        key: str,
        rows: Sequence[slice],
        make: Callable[[slice], TransferMatrix],
    ) -> tuple[Path, ...]:
        """Return the files of a matrix larger than memory, kept or just made."""
        kept = [self.store.holds(n, key) for n in block_names(name, len(rows))]
        self.found.setdefault(self.store.path(name, key).name, all(kept))
        return self.store.blocks(name, key, rows, make)
