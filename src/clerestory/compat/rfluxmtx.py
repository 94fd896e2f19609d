"""rfluxmtx: transfer matrices from rays or window patches to windows and sky patches.

References: G. Ward, manual page of rfluxmtx(1).
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from clerestory.checks import require
from clerestory.compat.ray_input import (
    RAY_OPTIONS,
    RayOptions,
    Table,
    write_columns,
)
from clerestory.compat.streams import Streams
from clerestory.compat.visible_surfaces import by_surface
from clerestory.compat.words import IGNORED, Grammar
from clerestory.engine.effort import Effort
from clerestory.errors import InputError
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.facade_matrices import facade_matrices
from clerestory.phases.picture_matrices import picture_view_matrices
from clerestory.phases.sky_views import sky_view_matrices
from clerestory.phases.traced_matrices import (
    daylight_coefficients,
    daylight_matrix,
    view_matrices,
)
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.receiver_reader import (
    Hemisphere,
    Receiver,
    WindowReceiver,
    read_receivers,
)
from clerestory.scene.model import Scene
from clerestory.scene.ray_bundles import RayBundles
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

_GRAMMAR = Grammar("rfluxmtx", {**IGNORED, **RAY_OPTIONS}, ("-f",))

# Radiance traces -ad rays at the first surface of each of -c rays of a pixel, this
# program one path with next-event estimation: as many paths as -c times this share of
# -ad have about the same noise
_PATHS = 8

# Paths per ray (-ad of sensors, -c of windows). In the tutorial's room, daylight
# coefficients of 10,000 rays have less noise from rcontrib, since its rays have one
# cell of the hemisphere each; with 4 paths per ray they have 0.6 times its noise
_PER_RAY = 4


def rfluxmtx(words: Sequence[str], streams: Streams) -> None:
    """Run rfluxmtx with the words of its command line."""
    call = _parse(words)
    receivers = _named(read_receivers(call.receivers), call.options.output)
    require(call.scene, "rfluxmtx: no scene; -i OCTREE or scene files expected")
    scene, given = read_rad(*call.scene), call.options
    if call.sender != "-":
        found = _from_window(scene, call.sender, receivers, given, streams)
    elif given.quantity == "sensor":
        sensors = given.sensors(streams)
        effort = _effort(given, streams, _PER_RAY * given.directions)
        found = _from_sensors(scene, sensors, receivers, effort)
    else:
        bundles = given.bundles(streams)
        found = _from_rays(scene, bundles, receivers, given, streams)
    write_columns(found, given, streams)


@dataclass(frozen=True)
class _Call:
    # Options, sender, receiver file and scene of a command line
    options: RayOptions
    sender: str
    receivers: str
    scene: tuple[str, ...] = field(default=())


def _parse(words: Sequence[str]) -> _Call:
    # After the receivers, -i OCTREE is the scene; before them, -i is irradiance
    given, left = RayOptions("rfluxmtx"), list(words)
    operands: list[str] = []
    scene: list[str] = []
    while left and len(operands) < 2:
        # Read words one by one, since the meaning of -i changes
        word = next(_GRAMMAR.words(left))
        del left[: 1 + len(word.arguments) * (word.name != "" and not word.joined)]
        if word.name:
            given = given.changed(word)
        else:
            operands.append(word.text)
    while left:
        name = left.pop(0)
        if name == "-i":
            require(left, "rfluxmtx: -i has no octree; its name expected")
            name = left.pop(0)
        scene.append(name)
    if len(operands) < 2:
        raise InputError(
            f"rfluxmtx: {len(operands)} of sender and receivers given; both expected"
        )
    return _Call(given, operands[0], operands[1], tuple(scene))


def _named(receivers: Sequence[Receiver], output: str | None) -> Sequence[Receiver]:
    # Receivers with an output each, if -o has %s, which stands for their modifier
    if output is None or "%s" not in output:
        return receivers
    return [
        replace(each, output=each.output or output.replace("%s", each.name))
        for each in receivers
    ]


def _effort(given: RayOptions, streams: Streams, samples: int) -> Effort:
    return Effort(
        samples=max(samples, 64),
        bounces=given.bounces,
        seed=given.seed,
        progress=streams.progress,
        components=False,
    )


def _from_window(
    scene: Scene,
    sender: str,
    receivers: Sequence[Receiver],
    given: RayOptions,
    streams: Streams,
) -> Iterator[tuple[str | None, Table]]:
    own = read_receivers(sender)
    require(
        len(own) == 1 and isinstance(own[0], WindowReceiver),
        "the sender has several modifiers or a source; polygons of one modifier"
        " expected",
        file=sender,
    )
    [from_] = own
    assert isinstance(from_, WindowReceiver)
    effort = _effort(given, streams, _PER_RAY * given.count)
    windows = _windows(receivers)
    facade = (
        facade_matrices(scene, from_.window, windows, effort=effort) if windows else {}
    )
    found: dict[int, TransferMatrix] = {}
    for mf in _subdivisions(receivers):
        found[mf] = daylight_matrix(scene, from_.window, subdivision=mf, effort=effort)
    yield from _columns(receivers, facade, found)


def _from_sensors(
    scene: Scene, sensors: Sensors, receivers: Sequence[Receiver], effort: Effort
) -> Iterator[tuple[str | None, Table]]:
    windows = _windows(receivers)
    views = (
        view_matrices(scene, windows, sensors=sensors, effort=effort) if windows else {}
    )
    skies = {
        mf: daylight_coefficients(scene, sensors=sensors, subdivision=mf, effort=effort)
        for mf in _subdivisions(receivers)
    }
    yield from _columns(receivers, views, skies)


def _from_rays(
    scene: Scene,
    bundles: RayBundles,
    receivers: Sequence[Receiver],
    given: RayOptions,
    streams: Streams,
) -> Iterator[tuple[str | None, Table]]:
    samples = given.count * max(1, given.directions // _PATHS)
    if given.quantity == "surface":
        effort = _effort(given, streams, max(1, given.directions // _PATHS))
        yield from by_surface(
            scene, bundles, _windows(receivers), effort,
            lambda sensors, own: _from_sensors(scene, sensors, receivers, own),
            lambda rays, own: _to_rays(scene, rays, receivers, own),
        )  # fmt: skip
        return
    yield from _to_rays(scene, bundles, receivers, _effort(given, streams, samples))


def _to_rays(
    scene: Scene, rays: RayBundles, receivers: Sequence[Receiver], effort: Effort
) -> Iterator[tuple[str | None, Table]]:
    windows = _windows(receivers)
    views = (
        picture_view_matrices(scene, windows, rays, effort=effort) if windows else {}
    )
    skies = {
        mf: sky_view_matrices(scene, rays, subdivision=mf, effort=effort)[0]
        for mf in _subdivisions(receivers)
    }
    yield from _columns(receivers, views, skies)


def _windows(receivers: Sequence[Receiver]) -> list[Window]:
    return [each.window for each in receivers if isinstance(each, WindowReceiver)]


def _subdivisions(receivers: Sequence[Receiver]) -> list[int]:
    # Subdivisions of the skies among the receivers; 1 if there is only ground
    halves = [each for each in receivers if isinstance(each, Hemisphere)]
    given = {each.subdivision for each in halves if each.subdivision}
    return sorted(given) or ([1] if halves else [])


def _columns(
    receivers: Sequence[Receiver],
    windows: dict[str, TransferMatrix],
    skies: dict[int, TransferMatrix],
) -> Iterator[tuple[str | None, Table]]:
    # Columns of each receiver; a single bin has the sum over the patches
    for each in receivers:
        if isinstance(each, WindowReceiver):
            yield each.output, windows[each.window.name].values
            continue
        values = skies[each.subdivision or min(skies)].values
        own = values[..., :1] if each.half == "ground" else values[..., 1:]
        if each.half == "sky" and each.subdivision is None:
            own = np.sum(own, axis=2, keepdims=True)
        yield each.output, own
