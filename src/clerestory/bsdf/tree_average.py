"""Averages of tensor trees over patches; flux is conserved."""

from typing import Literal

import numpy as np
from jaxtyping import Float
from scipy import sparse

from clerestory.array_types import ExitIncident, Slots
from clerestory.bsdf.patch_overlap import patches_in_cells
from clerestory.bsdf.tree_lookup import Cells, cells
from clerestory.hemisphere.partition import RingPartition

# Number of azimuth steps for rank 3 trees; Klems patch limits are at half steps.
_TURN_STEPS = 480


def average_tree(
    slots: Slots, rank: Literal[3, 4], exits: RingPartition, incidents: RingPartition
) -> ExitIncident:
    """BSDF of a tree averaged over pairs of patches [1/sr]."""
    groups = [group for group in cells(slots, rank) if len(group.value)]
    flux = (_turned_flux if rank == 3 else _flux)(groups, exits, incidents)
    measure = np.outer(
        exits.projected_solid_angles(), incidents.projected_solid_angles()
    )
    return np.asarray(flux / measure)


def _flux(
    groups: list[Cells], exits: RingPartition, incidents: RingPartition
) -> ExitIncident:
    # Flux between patches: sum of BSDF of cells times overlaps of cells and patches
    finest = max(group.level for group in groups)
    leave, enter = patches_in_cells(exits, finest), patches_in_cells(incidents, finest)
    flux = np.zeros((len(exits), len(incidents)))
    for level, place, value in groups:
        coarser = _coarser(finest, level)
        to, come = leave @ coarser, enter @ coarser
        wide = 1 << level
        table = sparse.csr_array(
            (
                value.astype(float),
                (place[2] * wide + place[3], place[0] * wide + place[1]),
            ),
            shape=(wide**2, wide**2),
        )
        flux += (to @ table @ come.T).toarray()
    return flux


def _turned_flux(
    groups: list[Cells], exits: RingPartition, incidents: RingPartition
) -> ExitIncident:
    # Calculate the flux from each incident ring to each azimuth step of each exit ring
    finest = max(group.level for group in groups)
    steps = RingPartition(
        "steps", np.full(len(exits.count), _TURN_STEPS), exits.theta, "polar"
    )
    leave = patches_in_cells(steps, finest)
    shape = len(incidents.count), len(exits.count), _TURN_STEPS
    ahead = np.zeros((shape[0], shape[1] * shape[2]))
    for level, place, value in groups:
        wide = 1 << level
        table = sparse.csr_array(
            (value.astype(float), (place[1] * wide + place[2], place[0])),
            shape=(wide**2, wide),
        )
        come = _rings_in_radii(incidents, wide)
        ahead += (come @ (leave @ _coarser(finest, level) @ table).T.toarray()) / (
            _TURN_STEPS
        )

    # Convolve the flux with the azimuths of incident and exit patches by FFT
    spectrum = np.fft.rfft(ahead.reshape(shape), axis=-1)
    flux = np.zeros((len(exits), len(incidents)))
    to = [np.fft.rfft(part, axis=-1) for part in _patches_over_steps(exits)]
    sources = [np.fft.rfft(part, axis=-1) for part in _patches_over_steps(incidents)]
    scale = np.full(spectrum.shape[-1], 2.0 / _TURN_STEPS)
    scale[[0, -1]] = 1.0 / _TURN_STEPS
    for i, source in enumerate(sources):
        columns = slice(incidents.first[i], incidents.first[i] + incidents.count[i])
        for o, target in enumerate(to):
            rows = slice(exits.first[o], exits.first[o] + exits.count[o])
            turned = source * spectrum[i, o] * scale
            flux[rows, columns] = (target.conj() @ turned.T).real
    return np.maximum(flux, 0)


def _coarser(finest: int, level: int) -> sparse.csr_array:
    # Matrix that sums the finest cells within each cell of a level
    along = np.arange(1 << finest) >> finest - level
    cell = ((along[:, None] << level) + along).ravel()
    return sparse.csr_array(
        (np.ones(len(cell)), (np.arange(len(cell)), cell)),
        shape=(len(cell), 1 << 2 * level),
    )


def _rings_in_radii(
    partition: RingPartition, wide: int
) -> Float[np.ndarray, "ring cells"]:
    # Projected solid angle [sr] of each ring in each cell of the first dimension
    radius = np.clip(1 - 2 * np.arange(wide + 1) / wide, 0, 1)
    ring = np.sin(partition.theta)
    low, high = np.sort([ring[:-1], ring[1:]], axis=0)[..., None]
    low, high = np.maximum(low, radius[1:]), np.minimum(high, radius[:-1])
    return np.pi * np.where(high > low, high**2 - low**2, 0)


def _patches_over_steps(
    partition: RingPartition,
) -> list[Float[np.ndarray, "patch step"]]:
    # Fraction of each azimuth step that lies in each patch, per ring
    halves = 2 * np.arange(_TURN_STEPS)[:, None] + np.array([-0.5, 0.5])
    phi = np.pi * halves / _TURN_STEPS
    middle = (partition.theta[:-1] + partition.theta[1:]) / 2
    shares = []
    for ring, theta in enumerate(middle):
        flat = np.sin(theta)
        direction = np.stack(
            [flat * np.cos(phi), flat * np.sin(phi), np.full_like(phi, np.cos(theta))],
            axis=-1,
        )
        patch = partition.find(direction) - partition.first[ring]
        inside = patch == np.arange(partition.count[ring])[:, None, None]
        shares.append(inside.mean(axis=-1))
    return shares
