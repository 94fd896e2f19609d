"""Window groups of a study, with polygons, shade states and control rule.

V and D are common to all shade states of a group, so all states have the hemisphere
partition of the finest BSDF. Tensor trees are averaged over Klems patches.
"""

import warnings
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from pathlib import Path

from clerestory.bands import RGB, Bands
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.spectral_channels import (
    bsdf_in_bands,
    has_bands,
    with_spectral_transmittance,
)
from clerestory.checks import require, within
from clerestory.control.schedule import StateSchedule, read_schedule
from clerestory.errors import ClerestoryWarning, InputError, located
from clerestory.hemisphere.partition import RingPartition
from clerestory.library.bsdf_source import read_bsdf
from clerestory.matrix.axis import Axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.window_reader import read_windows
from clerestory.scene.model import Scene
from clerestory.scene.scaling import scaled
from clerestory.scene.window import Window
from clerestory.spectral.spectrum_file import read_spectrum
from clerestory.study.control_fields import StateChoice
from clerestory.study.window_tables import (
    ControlTable,
    StateTable,
    WindowTable,
)


@dataclass(frozen=True, eq=False)
class WindowState:
    """Shade state of a window group; `name` is "" if the group has one state.

    `transmission` is the matrix T. `fine` is the BSDF for the direct sun, with its
    direct transmission extracted if `peak`. `shade` is the exterior shade.
    """

    name: str
    transmission: TransferMatrix
    fine: Bsdf
    peak: bool
    shade: Scene = field(default_factory=Scene)


@dataclass(frozen=True, eq=False)
class WindowGroup:
    """Window group with its shade states, the most open first, and its control rule.

    `inner` and `outer` are the same window, with the patches of its inner and its outer
    side. `ports` (F apertures) enclose exterior shades.
    """

    inner: Window
    outer: Window
    states: tuple[WindowState, ...]
    control: ControlTable | None = None
    ports: tuple[Window, ...] = ()

    @property
    def name(self) -> str:
        """Name of the window group."""
        return self.inner.name

    def scaled(self, factor: float) -> "WindowGroup":
        """Return the group with all lengths multiplied."""
        states = (replace(s, shade=scaled(s.shade, factor)) for s in self.states)
        return replace(
            self,
            inner=scaled(self.inner, factor),
            outer=scaled(self.outer, factor),
            states=tuple(states),
            ports=scaled(self.ports, factor),
        )

    def schedule(self) -> StateSchedule:
        """Return the schedule of the rule "schedule", checked for this group."""
        file = None if self.control is None else self.control.file
        if file is None:
            raise InputError('rule "schedule" without a file')
        schedule, what = read_schedule(file), f'the state of window "{self.name}"'
        with located(file=file):
            missing = f'no column "{self.name}"; a column for each window with this'
            require(self.name in schedule.states, f"{missing} rule expected")
            states = schedule.states[self.name]
            within(states, what, least=0, most=len(self.states) - 1)
        return schedule

    def number_of(self, choice: StateChoice) -> int:
        """Return the index of a shade state that is given by index or name."""
        if isinstance(choice, int):
            return choice
        return [state.name for state in self.states].index(choice)


def state_label(group: WindowGroup, at: int) -> str:
    """Return the label of a shade state in file names and progress displays."""
    return "-".join(filter(None, (group.name, group.states[at].name)))


def read_window_groups(
    table: WindowTable,
    *,
    read: Callable[[Path], Bsdf] = read_bsdf,
    bands: Bands = RGB,
) -> list[WindowGroup]:
    """Return one group per modifier in the window file, all with the same BSDFs.

    `read` is the function that reads a BSDF file. `bands` are those of the study.
    """
    tables = table.states()
    names = [state.label if len(tables) > 1 else state.name for state in tables]
    layers = [_spectral(read(state.bsdf), state, bands) for state in tables]
    fine = [
        _spectral(read(state.sun_bsdf), state, bands) if state.sun_bsdf else layer
        for state, layer in zip(tables, layers, strict=True)
    ]
    shades = [read_rad(*state.shade) if state.shade else Scene() for state in tables]
    ports = tuple(read_windows(table.ports)) if table.ports else ()
    windows = read_windows(table.file)
    groups = []
    for window in windows:
        label = f"{table.label}.{window.name}" if len(windows) > 1 else table.label
        matrices = _on_common_patches(layers, label, bands)
        states = tuple(
            WindowState(name, matrix, sharp, state.peak, shade)
            for name, matrix, sharp, state, shade in zip(
                names, matrices, fine, tables, shades, strict=True
            )
        )
        named = replace(window, name=label)
        inner = _with_patches(named, matrices[0].rows, file=tables[0].bsdf)
        outer = _with_patches(named, matrices[0].columns, file=tables[0].bsdf)
        groups.append(WindowGroup(inner, outer, states, table.control, ports))
    return groups


def _spectral(layer: Bsdf, table: StateTable, bands: Bands) -> Bsdf:
    # The layer in the bands of the study
    if bands == RGB:
        return layer
    if table.spectrum is None:
        return bsdf_in_bands(layer, bands)
    spectrum = read_spectrum(table.spectrum)
    with located(file=table.spectrum):
        return with_spectral_transmittance(layer, spectrum, bands)


def _on_common_patches(
    layers: list[Bsdf], window: str, bands: Bands
) -> list[TransferMatrix]:
    def matrix(layer: Bsdf, partition: RingPartition | None = None) -> TransferMatrix:
        known = bands if has_bands(layer, bands) else RGB
        return layer.transmission_matrix(
            partition=partition, window=window, bands=known
        )

    own = [matrix(layer) for layer in layers]
    finest = max(own, key=lambda matrix: matrix.rows.size)
    same = all(
        matrix.rows.fits(finest.rows) and matrix.columns.fits(finest.columns)
        for matrix in own
    )
    if same:
        return own
    partition = finest.rows.partition
    if not isinstance(partition, RingPartition):
        what = f'a BSDF of window "{window}" has no hemisphere basis'
        raise InputError(f"{what}; a Klems basis expected")
    return [matrix(layer, partition) for layer in layers]


def _with_patches(window: Window, axis: Axis, *, file: Path) -> Window:
    # Window with the hemisphere partition of its BSDF
    if not isinstance(axis.partition, RingPartition):
        raise InputError("has no hemisphere basis; a Klems basis expected", file=file)
    if not axis.partition.matches(window.partition):
        warnings.warn(
            f'{file}: has the {len(axis.partition)} patches of "{axis.partition.name}",'
            f' window "{window.name}" has the {len(window.partition)} of'
            f' "{window.partition.name}"; those of the BSDF are used',
            ClerestoryWarning,
            stacklevel=2,
        )
    return replace(window, partition=axis.partition)
