"""Bidirectional scattering distribution functions (BSDFs) of layers.

Directions are unit vectors that point away from the layer, in window coordinates: x
right, y up, z along the normal into the room.

*Front* is the outdoor side, as in LBNL WINDOW and its XML files: "transmission front"
is for daylight from outdoors into the room. Radiance calls the room side front and
swaps the names when it reads a file, so that "Transmission Front" in a file is for
daylight in Radiance, too.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from jaxtyping import Float

from clerestory.argument_types import checked_fields
from clerestory.array_types import Directions, Points2, Values
from clerestory.bands import RGB, Bands
from clerestory.brief_repr import brief
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_function import (
    CHUNK,
    FUNCTIONS,
    OTHER_SIDE,
    Function,
    ScatteringFunction,
    pairs_by_function,
)
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tree_arithmetic import xyz_functions
from clerestory.checks import one_of
from clerestory.colorimetry import rgb_from_xyz
from clerestory.errors import InputError, located
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.partition import RingPartition
from clerestory.matrix.axis import window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix

_Incident = Float[np.ndarray, "*incident 3"]
_Leaving = Float[np.ndarray, "*leaving 3"]
_Pair = Float[np.ndarray, "*pair"]
_Directions = Float[np.ndarray, "pair 3"]
_Answers = Float[np.ndarray, " pair"]


@checked_fields
@dataclass(frozen=True, eq=False)
class Bsdf:
    """Scattering of light by a layer, on both sides.

    Attributes
    ----------
    functions : scattering functions by channel ("visible", "solar", …) and name
    product : product information in the file
    notes : irregularities of the file and their treatment
    source : file name, for error messages

    Examples
    --------
    >>> from clerestory.bsdf.analytic import lambertian
    >>> from clerestory.hemisphere.klems import klems
    >>> frosted = lambertian(0.5, klems("full"))
    >>> frosted.transmission_matrix().values.shape
    (1, 145, 145)
    """

    functions: Mapping[tuple[str, Function], ScatteringFunction]
    product: Product = field(default_factory=Product)
    notes: tuple[str, ...] = ()
    source: str | None = None

    __repr__ = brief

    def __post_init__(self) -> None:
        for _, function in self.functions:
            one_of(function, "scattering function", choices=FUNCTIONS)

    @property
    def channels(self) -> tuple[str, ...]:
        """Names of the channels that have at least one scattering function."""
        return tuple(dict.fromkeys(channel for channel, _ in self.functions))

    def has(self, function: Function, *, channel: str = "visible") -> bool:
        """Whether a scattering function is available, directly or by reciprocity."""
        one_of(function, "scattering function", choices=FUNCTIONS)
        sides = function, OTHER_SIDE.get(function, function)
        return any((channel, side) in self.functions for side in sides)

    def scattering(
        self, name: Function, *, channel: str = "visible"
    ) -> ScatteringFunction:
        """Return one scattering function of the layer.

        If the transmission of only one side is given, the transmission of the other
        side follows by reciprocity.
        """
        if (channel, name) in self.functions:
            return self.functions[channel, name]
        other = OTHER_SIDE.get(name, name)
        if (channel, other) in self.functions:
            return self.functions[channel, other].reciprocal()
        known = ", ".join(f"{c} {f.replace('_', ' ')}" for c, f in self.functions)
        raise InputError(
            f"BSDF {self.product.name!r} has no {channel} {name.replace('_', ' ')};"
            f" it has {known or 'no data'}",
            file=self.source,
        )

    def tabulated(self) -> "Bsdf":
        """Return the layer with all functions as matrices or tensor trees."""
        parts = {key: part.tabulated() for key, part in self.functions.items()}
        return replace(self, functions=parts)

    def function(
        self,
        name: Function,
        *,
        channel: str = "visible",
        partition: RingPartition | None = None,
    ) -> ScatteringMatrix:
        """Return one scattering function as a matrix; flux is conserved.

        Parameters
        ----------
        partition : incident and exit patches; default: the partitions in the file, or
            Klems full for trees

        Raises
        ------
        InputError : the channel has no such function
        """
        part = self.scattering(name, channel=channel)
        if partition is None and isinstance(part, ScatteringMatrix):
            return part
        exits, incidents = part.own_partitions() or (klems("full"), klems("full"))
        if partition is not None:
            exits = incidents = partition
        return ScatteringMatrix(part.average(exits, incidents), exits, incidents)

    def transmission_matrix(
        self,
        channel: str = "visible",
        *,
        partition: RingPartition | None = None,
        window: str | None = None,
        bands: Bands = RGB,
    ) -> TransferMatrix:
        """Return the matrix T of the three-phase method, E = V·T·D·s.

        Entries are exit radiance per incident radiance: the BSDF times the projected
        solid angle of the incident patch. The visible channel is in RGB if the file has
        chromaticity data, otherwise grey.

        Parameters
        ----------
        partition : incident and exit patches; default: the partitions in the file, or
            Klems full for trees
        window : name of the window group; None matches every group

        Raises
        ------
        InputError : the channel has no transmission
        """
        parts = [
            self.function("transmission_front", channel=name, partition=partition)
            for name in (bands.names if bands != RGB else (channel,))
        ]
        front = parts[0]
        factors = np.stack([part.flux_factors() for part in parts])
        in_rgb = bands == RGB and channel == "visible"
        if in_rgb and self.in_colour("transmission_front"):
            measure = front.incidents.projected_solid_angles()
            xyz = [
                part.average(front.exits, front.incidents) * measure
                for part in self.xyz("transmission_front")
            ]
            factors = rgb_from_xyz(np.stack(xyz))
        return TransferMatrix(
            factors,
            window_axis("interior", front.exits, window),
            window_axis("exterior", front.incidents, window),
            bands=bands,
        )

    def direct_hemispherical(
        self,
        function: Function = "transmission_front",
        *,
        channel: str = "visible",
        partition: RingPartition | None = None,
    ) -> Values:
        """Directional-hemispherical transmittance or reflectance per incident patch."""
        part = self.function(function, channel=channel, partition=partition)
        return part.direct_hemispherical()

    def hemispherical(
        self, incident: Directions, *, function: Function, channel: str = "visible"
    ) -> Values:
        """Directional-hemispherical transmittance or reflectance."""
        return self.scattering(function, channel=channel).hemispherical(incident)

    def diffuse(self, function: Function, *, channel: str = "visible") -> float:
        """Hemispherical-hemispherical (diffuse) transmittance or reflectance."""
        return self.function(function, channel=channel).diffuse()

    def evaluate(
        self, incident: _Incident, leaving: _Leaving, *, channel: str = "visible"
    ) -> _Pair:
        """BSDF [1/sr] for pairs of directions that point away from the layer.

        The BSDF is zero where the channel has no scattering function.

        Raises
        ------
        InputError : the layer has no such channel
        """
        return self._over_pairs(
            lambda part, i, o: part.evaluate(i, o), incident, leaving, channel, 0.0
        )

    def resolution(
        self, incident: _Incident, leaving: _Leaving, *, channel: str = "visible"
    ) -> _Pair:
        """Projected solid angle [sr] of the exit cell or patch of each direction pair.

        Where the channel has no scattering function, the result is π (hemisphere).
        """
        return self._over_pairs(
            lambda part, i, o: part.resolution(i, o), incident, leaving, channel, np.pi
        )

    def sample(
        self,
        incident: Directions,
        u: Points2,
        *,
        function: Function,
        channel: str = "visible",
    ) -> tuple[Directions, Values]:
        """Sample exit directions; return them and their probability density [1/sr].

        The density is BSDF × exit cosine / directional-hemispherical transmittance or
        reflectance.

        Parameters
        ----------
        incident : directions towards the source, on the incident side of `function`
        u : random points in the unit square [0, 1)², one per direction
        """
        part = self.scattering(function, channel=channel)
        leaving, density = part.sample(incident, u)
        if function in ("transmission_back", "reflection_front"):
            leaving = leaving * [1, 1, -1]
        return leaving, density

    def _over_pairs(
        self,
        ask: Callable[[ScatteringFunction, _Directions, _Directions], _Answers],
        incident: _Incident,
        leaving: _Leaving,
        channel: str,
        missing: float,
    ) -> _Pair:
        # Evaluate each direction pair with the function of its incident and exit sides
        with located(file=self.source):
            what = f"channel of BSDF {self.product.name!r}"
            one_of(channel, what, choices=self.channels or ("none",))
        incident, leaving = np.broadcast_arrays(incident, leaving)
        answer = np.full(incident.shape[:-1], missing)
        flat, i, o = answer.reshape(-1), incident.reshape(-1, 3), leaving.reshape(-1, 3)
        parts: dict[Function, ScatteringFunction] = {}
        for start in range(0, len(flat), 4 * CHUNK):
            part = slice(start, start + 4 * CHUNK)
            for name, pairs in pairs_by_function(i[part], o[part]).items():
                if len(pairs) and self.has(name, channel=channel):
                    if name not in parts:
                        parts[name] = self.scattering(name, channel=channel)
                    these = i[part].take(pairs, axis=0), o[part].take(pairs, axis=0)
                    flat[start + pairs] = ask(parts[name], *these)
        return answer

    def in_colour(self, name: Function) -> bool:
        """Whether a function has colour data: channels CIE X and Z, or u′ and v′."""
        return any(
            all(self.has(name, channel=channel) for channel in pair)
            for pair in (("cie-x", "cie-z"), ("cie-u", "cie-v"))
        )

    def xyz(self, name: Function) -> tuple[ScatteringFunction, ...]:
        """Scattering functions of the tristimulus values X, Y and Z."""
        y = self.scattering(name)
        if self.has(name, channel="cie-x"):
            x, z = (self.scattering(name, channel=c) for c in ("cie-x", "cie-z"))
            return x, y, z
        u, v = (self.scattering(name, channel=c) for c in ("cie-u", "cie-v"))
        return xyz_functions(y, u, v)
