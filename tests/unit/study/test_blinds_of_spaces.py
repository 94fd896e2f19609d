"""Blinds by LM-83 in several spaces: each is operated by its own sensors."""

from types import SimpleNamespace

import numpy as np

from clerestory.study.control_inputs import ControlInputs
from clerestory.study.shade_operation import operate
from clerestory.study.window_tables import ControlTable

STEPS = 4
SUN = {"east": [0, 2000, 2000, 0], "west": [0, 0, 2000, 2000]}


class TwoRooms(ControlInputs):
    """Two rooms with a window each; the sun of one does not reach the other."""

    times = np.arange(STEPS)

    def direct(self, group, state, grid):
        name = self.inputs.groups[group].name
        open_share = np.where(np.asarray(state[0]) == 0, 1.0, 0.0)
        lux = np.array(SUN[name]) * open_share * (grid in (name, ""))
        return np.tile(lux, (10, 1))


def rooms(*grids):
    groups = [
        SimpleNamespace(
            name=name,
            states=("open", "closed"),
            control=ControlTable(rule="LM-83", grid=grid),
        )
        for name, grid in zip(SUN, grids, strict=True)
    ]
    signals = object.__new__(TwoRooms)
    object.__setattr__(signals, "inputs", SimpleNamespace(groups=groups))
    return operate(signals)


def test_blinds_close_by_the_sun_in_their_own_space():
    found = rooms("east", "west")
    assert [states.tolist() for states in found.states] == [[0, 1, 1, 0], [0, 0, 1, 1]]
    assert found.kept.all()


def test_blinds_of_one_grid_are_operated_together():
    """Any sunlit sensor closes a window until no sensor is left in the sun."""
    found = rooms("", "")
    assert [states.tolist() for states in found.states] == [[0, 1, 1, 0], [0, 0, 1, 1]]
