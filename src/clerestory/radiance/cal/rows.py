"""The state of an evaluation: sets of rays with what is known of them, and calls."""

from collections.abc import Callable, Hashable
from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Int

from clerestory.radiance.cal.library import Values
from clerestory.radiance.cal.syntax import Node


class Rows:
    """Some of the rays, and what is known of them.

    Attributes
    ----------
    index : which of all rays
    parent, place : the rays these were chosen from, and which of them
    known : values computed for them so far
    """

    def __init__(
        self,
        index: Int[np.ndarray, " rays"],
        parent: "Rows | None" = None,
        place: Bool[np.ndarray, " all"] | None = None,
    ) -> None:
        self.index, self.parent, self.place = index, parent, place
        self.known: dict[Hashable, Values] = {}

    def part(self, place: Bool[np.ndarray, " all"]) -> "Rows":
        """Return some of these rays."""
        return Rows(self.index[place], self, place)

    def find(self, key: Hashable) -> Values | None:
        """Return what is known under a key here or among the rays chosen from."""
        value = self.known.get(key)
        if value is None and self.parent is not None:
            outer = self.parent.find(key)
            if outer is not None:
                value = self.known[key] = outer[self.place]
        return value

    def once(self, key: Hashable, compute: Callable[[], Values]) -> Values:
        """Return what is known under a key, computed now if nothing is."""
        value = self.find(key)
        if value is None:
            value = self.known[key] = compute()
        return value


@dataclass(frozen=True, eq=False)
class Frame:
    """A call in progress.

    Attributes
    ----------
    parameters : their names
    arguments : what was given for them
    outer : the call in which the arguments have their meaning
    """

    parameters: tuple[str, ...]
    arguments: tuple[Node, ...]
    outer: "Frame | None"
