"""Layers that are known at every direction, and what the interpolant makes of them."""

from typing import NamedTuple

import numpy as np
from straight_lines import plain_means, straight_lines

import traced_layer as traced
from clerestory.bsdfgen.film_geometry import prismatic
from clerestory.bsdfgen.venetian_geometry import microlouvre
from clerestory.gonio.angles import from_degrees
from clerestory.gonio.fitted_measurement import Fitted, fit_measurement
from clerestory.gonio.scattering_measurement import Measurement
from goniometer import (
    Goniophotometer,
    film,
    half_circle,
    louvre,
    pane,
    quarter_circle,
    rings,
)

FRONT = np.array([1.0, 1.0, -1.0])
SEED = 2311  # of the directions at which truths are compared
PATHS = 1 << 16  # from each direction
JUMP = 0.2  # corners of a triangle whose fluxes differ by more have an edge between


def layers():
    """Yield name, layer and incident directions of the virtual goniophotometer."""
    yield (
        "microlouvre",
        traced.TracedLayer(microlouvre(), paths=PATHS),
        quarter_circle(),
    )
    film_ = prismatic(upper_angle_deg=80, lower_angle_deg=8)
    yield (
        "prismatic film, 80° and 8°",
        traced.TracedLayer(film_, paths=PATHS),
        half_circle(),
    )
    yield (
        "prismatic film, 45°",
        traced.TracedLayer(prismatic(), paths=PATHS),
        half_circle(),
    )
    pane_ = traced.TracedLayer(traced.rough_pane(), paths=PATHS)
    yield "rough pane", pane_, quarter_circle()
    yield "formula: film", film, half_circle()
    yield "formula: louvre", louvre, quarter_circle()
    yield "formula: pane", pane, rings(azimuths_deg=[0], step_deg=5.0)


class Known(NamedTuple):
    """Errors of one layer at 60 directions that were not measured.

    Attributes
    ----------
    known : exact fluxes at the scans
    errors : of flux, of the brightest beam [°], ghosts
    turns : errors of all beams [°]
    plain : ghosts of the mean of neighbours
    straight : errors of exact fluxes, straight between neighbours
    crossed : directions in triangles with an edge of the flux
    """

    name: str
    layer: object
    measurement: Measurement
    fitted: Fitted
    known: np.ndarray
    errors: np.ndarray
    turns: np.ndarray
    plain: np.ndarray
    straight: np.ndarray
    crossed: int


def known_truths():
    """Yield the errors of each layer."""
    directions = fresh_directions()
    for name, layer, incidents in layers():
        if isinstance(layer, traced.TracedLayer):
            lights = layer.light(incidents)
            measurement = traced.measure(incidents, lights, name=name)
            known = np.array([light.total for light in lights])
            truth = layer.light(directions)
        else:
            measurement = Goniophotometer().measure(layer, incidents)
            known = np.array([layer(d).total for d in incidents])
            truth = [traced.drawn(layer(d)) for d in directions]
        fitted = fit_measurement(measurement)
        found = list(fitted.interpolant.lobes_of(directions * FRONT))
        lights = [traced.drawn(one) for one in found]
        pairs = list(zip(lights, truth, strict=True))
        means = map(traced.drawn, plain_means(fitted.interpolant, directions))
        plain = [traced.compare(*pair)[2] for pair in zip(means, truth, strict=True)]
        straight, across = straight_lines(
            fitted.interpolant, incidents, known, directions
        )
        yield Known(
            name, layer, measurement, fitted, known,
            np.array([traced.compare(*pair) for pair in pairs]),
            np.concatenate([traced.turned_by(*pair) for pair in pairs]),
            np.array(plain),
            straight - np.array([light.total for light in truth]),
            int(np.sum(across > JUMP)),
        )  # fmt: skip


def fresh_directions():
    """60 incident directions that were not measured, up to 75° from the normal."""
    rng = np.random.default_rng(SEED)
    sine = np.sqrt(rng.random(60)) * np.sin(np.radians(75))
    return from_degrees(np.degrees(np.arcsin(sine)), rng.uniform(0, 360, 60))
