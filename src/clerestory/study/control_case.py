"""Case of a control rule: one window group, with the states of the others."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from clerestory.study.control_inputs import ControlInputs
from clerestory.study.window_tables import ControlTable

StateTimes = Int[np.ndarray, " time"]


@dataclass(frozen=True, eq=False)
class Case:
    """Inputs of the control rule of one window group, given by its index `number`.

    `others` has the shade states of all groups; entry `number` is ignored.
    """

    signals: ControlInputs
    number: int
    control: ControlTable
    others: list[StateTimes]

    @property
    def count(self) -> int:
        """Number of shade states of the group."""
        return len(self.signals.inputs.groups[self.number].states)

    def with_state(self, state: int) -> list[StateTimes]:
        """Shade states of all groups, with this group always in state `state`."""
        states = list(self.others)
        states[self.number] = np.full_like(states[self.number], state)
        return states

    def illuminance(self, grid: str) -> list[Float[np.ndarray, "sensor time"]]:
        """Illuminance [lux] of a grid for each shade state of this group."""
        states = map(self.with_state, range(self.count))
        return [self.signals.illuminance(state, grid) for state in states]

    def melanopic_edi(self, grid: str) -> list[Float[np.ndarray, "sensor time"]]:
        """Melanopic EDI [lux] of a grid for each shade state of this group."""
        states = map(self.with_state, range(self.count))
        return [self.signals.melanopic_edi(state, grid) for state in states]
