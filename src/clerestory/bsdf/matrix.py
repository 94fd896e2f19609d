"""BSDFs as matrices from incident patches to exit patches.

Directions are unit vectors that point away from the layer, in the frame of the
window: x right, y up, z along the normal into the room.

*Front* is the side towards the sky, as in LBNL's WINDOW and in its XML files:
"transmission front" takes daylight from outside into the room. Radiance calls
the room side front and swaps the names while it reads a file; it uses the
"Transmission Front" of the file for daylight all the same, and so do we.

Exit patch i is the patch i of its partition, mirrored in z for light that leaves
to the outside. Incident patch i is where light must come from to travel straight
on, into exit patch i of the other side: daylight through it comes from the
direction opposite to the centre of patch i, and light that is reflected back by a
mirror keeps its number too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, get_args

import numpy as np
from jaxtyping import Bool, Float, Int

from clerestory.bsdf.colour import rgb_from_xyz
from clerestory.bsdf.product import Product
from clerestory.errors import InputError
from clerestory.hemisphere.partition import RingPartition
from clerestory.matrix.axis import window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix

Function = Literal[
    "transmission_front", "transmission_back", "reflection_front", "reflection_back"
]
FUNCTIONS: tuple[Function, ...] = get_args(Function)

_OTHER_SIDE: dict[Function, Function] = {
    "transmission_front": "transmission_back",
    "transmission_back": "transmission_front",
}


@dataclass(frozen=True, eq=False)
class ScatteringMatrix:
    """One scattering function of a layer on patches, in one channel.

    Attributes
    ----------
    values : BSDF from each incident patch to each exit patch [1/sr]
    exits, incidents : partitions of the hemispheres

    Raises
    ------
    InputError : shape and partitions disagree, or a value is negative or not finite
    """

    values: Float[np.ndarray, "exit incident"]
    exits: RingPartition
    incidents: RingPartition

    def __post_init__(self) -> None:
        if self.values.shape != (len(self.exits), len(self.incidents)):
            raise InputError(
                f"BSDF of shape {self.values.shape}; {len(self.exits)} exit patches by"
                f" {len(self.incidents)} incident patches expected"
            )
        if not np.all(np.isfinite(self.values)) or np.any(self.values < 0):
            raise InputError("the BSDF holds negative or infinite values [1/sr]")

    def direct_hemispherical(self) -> Float[np.ndarray, " incident"]:
        """Share of the light from each incident patch that is scattered in all."""
        share: Float[np.ndarray, " incident"] = (
            self.exits.projected_solid_angles() @ self.values
        )
        return share

    def flux_factors(self) -> Float[np.ndarray, "exit incident"]:
        """Exit radiance per radiance of each incident patch, as in matrix files."""
        factors: Float[np.ndarray, "exit incident"] = (
            self.values * self.incidents.projected_solid_angles()
        )
        return factors

    def reciprocal(self) -> "ScatteringMatrix":
        """Return the transmission of the other side by Helmholtz reciprocity."""
        incident = _opposite(self.exits)
        leaving = _opposite(self.incidents)
        return ScatteringMatrix(
            self.values[np.ix_(incident, leaving)].T, self.incidents, self.exits
        )


@dataclass(frozen=True, eq=False)
class Bsdf:
    """What a layer does to light that meets it, from both sides.

    Attributes
    ----------
    functions : scattering per channel ("visible", "solar", …) and function
    product : what the file says about the layer
    notes : what was odd in the file and how it was read
    source : the file it came from, for messages

    Examples
    --------
    >>> from clerestory.bsdf.analytic import lambertian
    >>> from clerestory.hemisphere.klems import klems
    >>> frosted = lambertian(0.5, klems("full"))
    >>> frosted.transmission_matrix().values.shape
    (1, 145, 145)
    """

    functions: Mapping[tuple[str, Function], ScatteringMatrix]
    product: Product = field(default_factory=Product)
    notes: tuple[str, ...] = ()
    source: str | None = None

    @property
    def channels(self) -> tuple[str, ...]:
        """Channels of which the layer has any function."""
        return tuple(dict.fromkeys(channel for channel, _ in self.functions))

    def has(self, function: Function, *, channel: str = "visible") -> bool:
        """Whether the function is known, itself or through reciprocity."""
        other = _OTHER_SIDE.get(function, function)
        return (channel, function) in self.functions or (
            channel,
            other,
        ) in self.functions

    def function(self, name: Function, *, channel: str = "visible") -> ScatteringMatrix:
        """Return one scattering function.

        A transmission given for one side only serves the other by reciprocity.

        Raises
        ------
        InputError : there is no such function in this channel
        """
        if (channel, name) in self.functions:
            return self.functions[channel, name]
        other = _OTHER_SIDE.get(name, name)
        if (channel, other) in self.functions:
            return self.functions[channel, other].reciprocal()
        known = ", ".join(f"{c} {f.replace('_', ' ')}" for c, f in self.functions)
        raise InputError(
            f"BSDF {self.product.name!r} has no {channel} {name.replace('_', ' ')};"
            f" it has {known or 'no data'}",
            file=self.source,
        )

    def transmission_matrix(
        self, channel: str = "visible", *, window: str | None = None
    ) -> TransferMatrix:
        """Return the matrix T of the three-phase method, E = V·T·D·s.

        Each entry is the radiance that leaves into a patch of the room per radiance
        that arrives from a patch outside: the BSDF times the projected solid angle
        of the incident patch. The visible channel is in RGB if the file has CIE X
        and Z beside it, grey otherwise.

        Parameters
        ----------
        window : name of the window group it stands in; None fits all

        Raises
        ------
        InputError : the layer has no transmission in this channel
        """
        front = self.function("transmission_front", channel=channel)
        factors = front.flux_factors()[None]
        if channel == "visible" and self._in_colour("transmission_front", front):
            xyz = [
                self.function("transmission_front", channel=name).flux_factors()
                for name in ("cie-x", "visible", "cie-z")
            ]
            factors = rgb_from_xyz(np.stack(xyz))
        return TransferMatrix(
            factors,
            window_axis("interior", front.exits, window),
            window_axis("exterior", front.incidents, window),
        )

    def direct_hemispherical(
        self, function: Function = "transmission_front", *, channel: str = "visible"
    ) -> Float[np.ndarray, " incident"]:
        """Share of the light from each incident patch that is scattered in all."""
        return self.function(function, channel=channel).direct_hemispherical()

    def evaluate(
        self,
        incident: Float[np.ndarray, "*incident 3"],
        leaving: Float[np.ndarray, "*leaving 3"],
        *,
        channel: str = "visible",
    ) -> Float[np.ndarray, "*pair"]:
        """BSDF [1/sr] for pairs of directions that point away from the layer.

        A function the layer does not have is zero.
        """
        incident, leaving = np.broadcast_arrays(incident, leaving)
        from_sky, to_room = incident[..., 2] < 0, leaving[..., 2] > 0
        value = np.zeros(incident.shape[:-1])
        cases: dict[Function, Bool[np.ndarray, "*pair"]] = {
            "transmission_front": from_sky & to_room,
            "transmission_back": ~from_sky & ~to_room,
            "reflection_front": from_sky & ~to_room,
            "reflection_back": ~from_sky & to_room,
        }
        for name, pairs in cases.items():
            if self.has(name, channel=channel) and np.any(pairs):
                part = self.function(name, channel=channel)
                enter = part.incidents.find(_upright(incident[pairs] * [-1, -1, 1]))
                leave = part.exits.find(_upright(leaving[pairs]))
                value[pairs] = part.values[leave, enter]
        return value

    def _in_colour(self, name: Function, like: ScatteringMatrix) -> bool:
        return all(
            self.has(name, channel=channel)
            and self.function(name, channel=channel).values.shape == like.values.shape
            for channel in ("cie-x", "cie-z")
        )


def _opposite(partition: RingPartition) -> Int[np.ndarray, " patches"]:
    # Patch on the other side of the pole, half a turn away
    turned = partition.centres() * [-1, -1, 1]
    return partition.find(turned)


def _upright(direction: Float[np.ndarray, "*batch 3"]) -> Float[np.ndarray, "*batch 3"]:
    # Mirror directions of the sky side to the room side
    return np.concatenate([direction[..., :2], np.abs(direction[..., 2:])], axis=-1)
