"""Evaluation and sampling of BSDF matrices in kernels.

The four functions of a layer are stored consecutively, each as a matrix with a row for
each exiting patch and a column for each incident patch. A path is traced against the
direction of light: for a given exiting direction, an incident patch is sampled in
proportion to its contribution.
"""

from collections.abc import Sequence

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.engine.patches import PatchTable
from clerestory.engine.upload import on_device, search


class MatrixTable:
    """Scattering matrices of one layer, on common partitions.

    A scattering function has three matrices (colour) or one, and is None if undefined.
    """

    def __init__(self, functions: Sequence[tuple[ScatteringMatrix, ...] | None]):
        first = next(part[0] for part in functions if part is not None)
        exits, incidents = len(first.exits), len(first.incidents)
        measure = first.incidents.projected_solid_angles()
        self.colours = max(len(part) for part in functions if part is not None)
        values = np.zeros((len(functions), exits, incidents, self.colours))
        proposal = np.zeros((len(functions), exits, incidents))
        for number, part in enumerate(functions):
            if part is not None:
                values[number] = np.stack([p.values for p in part], axis=-1)
                proposal[number] = np.mean(values[number], axis=-1)

        # Cumulative fraction of the exiting light over the incident patches
        flux = proposal * measure
        total = flux.sum(axis=-1, keepdims=True)
        running = np.cumsum(flux, axis=-1) / np.where(total > 0, total, 1)
        running = running / np.where(total > 0, running[..., -1:], 1)
        density = proposal / np.where(total > 0, total, 1)
        self.exit = PatchTable.of(first.exits)
        self.incident = PatchTable.of(first.incidents)
        self.exits, self.incidents = exits, incidents
        self.values = on_device(mi.Float, values)
        self.density = on_device(mi.Float, density)
        self.running = on_device(mi.Float, running)
        self.share = on_device(mi.Float, total)

    def known(self, function, leaving):
        """Return the row of a function for an exiting direction."""
        return function * self.exits + self.exit.find(leaving)

    def gathered(self, function, leaving):
        """Return the exiting radiance for a uniform incident radiance of one."""
        return dr.gather(mi.Float, self.share, self.known(function, leaving))

    def evaluate(self, function, incident, leaving):
        """Return the BSDF [1/sr], and the pdf per projected solid angle [1/sr]."""
        through = mi.Vector3f(-incident.x, -incident.y, incident.z)
        cell = self.known(function, leaving) * self.incidents
        cell += self.incident.find(through)
        return self._value(cell), dr.gather(mi.Float, self.density, cell)

    def sample(self, function, leaving, u, v):
        """Sample an incident direction; return its disc point, BSDF value and pdf."""
        row = self.known(function, leaving) * self.incidents
        patch = search(self.running, self.incidents, u, row)
        cell = row + patch
        high = dr.gather(mi.Float, self.running, cell)
        low = dr.gather(mi.Float, self.running, cell - 1, patch > 0)
        rest = dr.clip((u - low) / (high - low), 0, 0.9999999)
        through = self.incident.sample(patch, rest, v)
        density = dr.gather(mi.Float, self.density, cell)
        return mi.Point2f(-through.x, -through.y), self._value(cell), density

    def colour(self, value):
        """Convert a BSDF value of the table to RGB."""
        return value

    def _value(self, cell):
        if self.colours == 1:
            return mi.Color3f(dr.gather(mi.Float, self.values, cell))
        return dr.gather(mi.Color3f, self.values, cell)
