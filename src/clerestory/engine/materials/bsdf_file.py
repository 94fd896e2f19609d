"""BSDF files as a Mitsuba plugin: `{"type": "bsdf_file", "filename": "blind.xml"}`.

The plugin evaluates the visible-light data of a `Bsdf` (matrices or tensor trees) for
both sides, and adds diffuse reflection and transmission as Radiance's BSDF material.
Directions are transformed to the frame of the layer, defined by the up vector and by
the surface normal, which points into the room.

With `peak`, direct transmission is separated from the other data, as by Radiance's
aBSDF: light and shadow rays pass undeflected, as through a pane.

Transmission and reflection are sampled in proportion to the light scattered from a
uniform radiance. A ratio of the radiances behind and in front changes the proportion
(`expect`), not the values.
"""

import itertools

import drjit as dr
import mitsuba as mi
import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_function import FUNCTIONS, OTHER_SIDE, Function
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.tensor_tree import ScatteringTree
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.colorimetry import rgb_from_xyz
from clerestory.engine.materials.properties import colour
from clerestory.engine.materials.queries import (
    completed,
    either,
    sampled,
    set_components,
)
from clerestory.engine.matrix_table import MatrixTable
from clerestory.engine.peak_extraction import PeakTable
from clerestory.engine.tree_table import TreeTable
from clerestory.engine.upload import vectors

Table = MatrixTable | TreeTable

_REVERSE = [FUNCTIONS.index(OTHER_SIDE.get(name, name)) for name in FUNCTIONS]


def scattering_table(bsdf: Bsdf) -> Table:
    """Return the visible scattering functions of a layer as Dr.Jit arrays."""
    bsdf = bsdf.tabulated()
    parts = [_colours(bsdf, name) for name in FUNCTIONS]
    trees = [p for p in parts if p is not None and isinstance(p[0], ScatteringTree)]
    if trees and len({p[0].rank for p in trees}) == 1 == len(
        {isinstance(p[0], ScatteringTree) for p in parts if p is not None}
    ):
        return TreeTable(parts, _REVERSE)
    return MatrixTable(_matrices(bsdf))


def forward_table(bsdf: Bsdf, name: Function = "transmission_front") -> Table:
    """Return a table for sampling the leaving direction of transmitted light.

    The table holds the reciprocal function, whose leaving direction is the actual
    incident direction and vice versa.
    """
    bsdf = bsdf.tabulated()
    parts = _colours(bsdf, name)
    if parts is not None and isinstance(parts[0], ScatteringTree):
        if parts[0].rank == 3:
            # BSDF function 0 is function 1 with both directions exchanged
            return TreeTable([None, parts], [1, 0])
        return TreeTable([tuple(part.reciprocal() for part in parts)], [0])
    matrices = _matrices(bsdf)[FUNCTIONS.index(name)]
    return MatrixTable([tuple(part.reciprocal() for part in matrices)])


def _colours(bsdf: Bsdf, name: Function):
    # Trees or matrices of a function: X, Y, Z if it is coloured, otherwise Y only
    if not bsdf.has(name):
        return None
    part = bsdf.scattering(name)
    if isinstance(part, ScatteringTree) and bsdf.in_colour(name):
        return bsdf.xyz(name)
    # Rank 3 data given for one side only are evaluated by reciprocity in the table
    known = isinstance(part, ScatteringTree | ScatteringMatrix)
    return (part,) if known else None


def _matrices(bsdf: Bsdf):
    # Resample all functions to the patches of the first; coloured if the file is
    first = next(name for name in FUNCTIONS if bsdf.has(name))
    like = bsdf.function(first)
    found = []
    for name in FUNCTIONS:
        if not bsdf.has(name):
            found.append(None)
            continue
        parts = bsdf.xyz(name) if bsdf.in_colour(name) else (bsdf.scattering(name),)
        tables = [part.average(like.exits, like.incidents) for part in parts]
        if len(tables) == 3:
            tables = list(rgb_from_xyz(np.stack(tables)))
        found.append(
            tuple(ScatteringMatrix(t, like.exits, like.incidents) for t in tables)
        )
    return found


PLUGIN = "bsdf_file"


def define() -> type:
    """Return the plugin's class for the current variant."""

    @completed(up="up")
    class BsdfFile(mi.BSDF):
        """Scattering by the data of a BSDF file, plus diffuse scattering.

        The added diffuse scattering has a reflectance of the front (the side of the
        normal, which faces the room), a reflectance of the back, and a transmittance.
        """

        def __init__(self, props):
            mi.BSDF.__init__(self, props)
            up = props.get("up", mi.ScalarPoint3f(0, 0, 1))
            self.up = vectors(mi.Vector3f, [np.ravel(up)])
            self.front = colour(props, "front", 0.0)
            self.back = colour(props, "back", 0.0)
            self.transmission = colour(props, "transmission", 0.0)
            self.behind = dr.opaque(mi.Float, 1)
            self.sharp = bool(props.get("peak", False))
            self.peak = None
            self._flag()
            filename = props.get("filename", "")
            if filename:
                self.take(read_bsdf(filename))

        def _flag(self):
            flags = mi.BSDFFlags
            glossy = flags.GlossyReflection, flags.GlossyTransmission
            diffuse = flags.DiffuseReflection, flags.DiffuseTransmission
            straight = () if self.peak is None else (flags.Null,)
            set_components(self, *glossy, *diffuse, *straight)

        def take(self, bsdf):
            """Set the scattering data from a `Bsdf`."""
            bsdf = bsdf.tabulated()
            self.table = scattering_table(bsdf)
            if self.sharp:
                self.peak = PeakTable(bsdf)
            self._flag()

        def turned(self, si):
            """Return the layer's frame; zero axes if up is parallel to the normal."""
            normal = si.sh_frame.n
            right = dr.cross(self.up, normal)
            length = dr.norm(right)
            right *= dr.select(length > 1e-6, 1 / length, 0)
            return mi.Frame3f(right, dr.cross(normal, right), normal)

        def split(self, si, wo):
            """Return wi and wo in the layer's frame, and whether the frame has axes."""
            frame = self.turned(si)
            wi = frame.to_local(si.sh_frame.to_world(si.wi))
            oriented = dr.squared_norm(frame.s) > 0.5
            return wi, frame.to_local(si.sh_frame.to_world(wo)), oriented

        def parts(self, wi):
            """Return scattering functions for the side of wi, and probabilities."""
            room = wi.z > 0
            transmission = dr.select(room, mi.UInt32(0), mi.UInt32(1))
            reflection = dr.select(room, mi.UInt32(3), mi.UInt32(2))
            passed = self.table.gathered(transmission, wi)
            mirrored = self.table.gathered(reflection, wi)
            spread = dr.max(dr.select(room, self.front, self.back))
            through = dr.max(self.transmission)
            straight = mi.Float(0)
            if self.peak is not None:
                straight = dr.max(self.peak.transmittance(wi))
            beyond = dr.select(room, self.behind, 1 / self.behind)
            passed, through, straight = (
                each * beyond for each in (passed, through, straight)
            )
            total = passed + mirrored + spread + through + straight
            scale = dr.select(total > 0, 1 / total, 0)
            chances = [passed, mirrored, spread, through, straight]
            return transmission, reflection, [c * scale for c in chances]

        def evaluate(self, si, wo, active):
            """Return BSDF × cosine [1/sr] and pdf, without direct transmission."""
            wi, wo, oriented = self.split(si, mi.Vector3f(wo))
            transmission, reflection, chance = self.parts(wi)
            same = wi.z * wo.z > 0
            function = dr.select(same, reflection, transmission)
            value, density = self.table.evaluate(function, wo, wi)
            value = self.table.colour(value)
            if self.peak is not None:
                value = dr.select(same, value, self.peak.without(value, wi, wo))
            added = dr.select(wi.z > 0, self.front, self.back)
            value += dr.select(same, added, self.transmission) * dr.inv_pi
            pdf = dr.select(same, chance[1], chance[0]) * density
            pdf += dr.select(same, chance[2], chance[3]) * dr.inv_pi
            cosine = dr.abs(wo.z)
            active = active & oriented & (cosine > 0) & (wi.z != 0)
            return tuple(dr.select(active, each * cosine, 0) for each in (value, pdf))

        def sample(self, ctx, si, sample1, sample2, active=True):
            frame = self.turned(si)
            wi = frame.to_local(si.sh_frame.to_world(si.wi))
            transmission, reflection, chance = self.parts(wi)
            edge = list(itertools.accumulate(chance))
            through = sample1 < edge[0]
            mirrored = (sample1 >= edge[0]) & (sample1 < edge[1])
            scattered = through | mirrored
            diffuse = sample1 < edge[2]
            straight = sample1 >= edge[3]
            opposite = through | ((sample1 >= edge[2]) & ~straight)

            function = dr.select(mirrored, reflection, transmission)
            u, v = sample2.x, sample2.y
            disc, _, _ = self.table.sample(function, wi, u, v)
            cosine = mi.warp.square_to_cosine_hemisphere(sample2)
            disc = dr.select(scattered, disc, mi.Point2f(cosine.x, cosine.y))
            height = dr.safe_sqrt(1 - dr.squared_norm(disc))
            side = dr.select(opposite, -1.0, 1.0) * dr.sign(wi.z)
            wo = mi.Vector3f(disc.x, disc.y, height * side)
            wo = si.sh_frame.to_local(frame.to_world(wo))
            value, pdf = self.evaluate(si, wo, active)
            weight = dr.select(pdf > 0, value / pdf, 0)
            flags = mi.BSDFFlags
            lobe = either(through, flags.GlossyTransmission, flags.GlossyReflection)
            even = either(diffuse, flags.DiffuseReflection, flags.DiffuseTransmission)
            kind = dr.select(scattered, lobe, even)
            if self.peak is not None:
                wo = dr.select(straight, -si.wi, wo)
                passed = self.peak.transmittance(wi) / chance[4]
                weight = dr.select(straight, passed, weight)
                pdf = dr.select(straight, chance[4], pdf)
                kind = dr.select(straight, mi.UInt32(+mi.BSDFFlags.Null), kind)
            bs = sampled(wo, dr.select(active, pdf, 0), kind)
            valid = active & (pdf > 0)
            return bs, dr.select(valid, mi.Color3f(weight), 0)

        def eval_pdf(self, ctx, si, wo, active=True):
            return self.evaluate(si, wo, active)

        def eval_null_transmission(self, si, active=True):
            if self.peak is None:
                return mi.Color3f(0)
            wi = self.turned(si).to_local(si.sh_frame.to_world(si.wi))
            return self.peak.transmittance(wi)

    return BsdfFile


def expect(made, behind: float) -> None:
    """Set the expected ratio of the radiances behind and in front of a layer."""
    made.behind = dr.opaque(mi.Float, behind)


def vary(made, name: str, bsdf: Bsdf, origin) -> None:
    """Set the scattering data from a `Bsdf`."""
    made.take(bsdf)
