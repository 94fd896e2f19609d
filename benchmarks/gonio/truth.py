"""The page of known truths, and its figures."""

from dataclasses import replace

import numpy as np
from known_layers import FRONT, JUMP, SEED, known_truths
from matplotlib.figure import Figure
from page import head, save, spread

from clerestory.gonio.angles import from_degrees
from clerestory.report.gonio_plots import between_figure, fit_figure

CURVE_PATHS = 1 << 14  # from each direction of a curve of the flux


def lines(_data):
    """Yield the page of layers that are known."""
    yield from head("Measurements to BSDFs: known truth")
    yield (
        "Virtual goniophotometer: light of generated systems traced from discs of"
        " 0.25°, seen through an aperture of 0.7° (that of trees of 2⁷ cells), 2 %"
        " noise, an arm that hides a sector, nothing beyond 87°; and sums of lobes by"
        f" formula. Errors at 60 directions that were not measured (seed {SEED}), up"
        " to 75° from the normal: median / 9th decile / largest. Flux is a share of"
        " the incident light. *Straight lines* are interpolated linearly between"
        " exact fluxes at the same directions. *Crossed* ones lie between scans whose"
        f" exact fluxes differ by more than {JUMP:g}, so that there is an edge between"
        " them. A beam is light of the reference within 6° of its centroid, at least"
        " 5 % of the incident light; its error is the angle to the centroid of the"
        " predicted light there. A spurious beam (*ghost*) is light within 3° of a"
        " direction more than 4° from any light of the reference, relative to the"
        " brightest such direction of the reference; *plain mean* is the same for the"
        " mean of the neighbouring scans."
    )
    yield ""
    yield (
        "| layer | scans | flux | over 2 % | straight lines | over 2 % | crossed |"
        " brightest beam [°] | over 2° | all beams [°] | over 2° | ghost |"
        " plain mean |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|---|---|---|"
    for known in known_truths():
        flux, peak, ghost = known.errors.T
        cells = [
            f"{len(known.measurement.scans)}",
            spread(flux, 4), f"{np.sum(np.abs(flux) > 0.02)}",
            spread(known.straight, 4), f"{np.sum(np.abs(known.straight) > 0.02)}",
            f"{known.crossed}",
            spread(peak, 2), f"{np.sum(peak > 2)}",
            spread(known.turns, 2), f"{np.sum(known.turns > 2)} of {len(known.turns)}",
            spread(ghost, 2), spread(known.plain, 2),
        ]  # fmt: skip
        yield f"| {known.name} | {' | '.join(cells)} |"
        figures(known)


def figures(known):
    """Write the figures of a layer."""
    if known.name == "formula: film":
        fit = fit_figure(known.measurement, known.fitted.interpolant, 34)
        save(fit, "gonio-film-fit")
        ends = from_degrees(np.array([40.0, 50]), np.array([45.0, 67.5]))
        save(between_figure(known.fitted.interpolant, *ends), "gonio-film-between")
    if known.name.startswith("prismatic film, 45"):
        save(flux_figure(known), "gonio-film-flux")


def flux_figure(known):
    """Flux of a film in the plane across its prisms, and what scans say about it."""
    theta = np.arange(-80.0, 80.1, 1.0)
    directions = from_degrees(theta, 90.0)
    layer = replace(known.layer, paths=CURVE_PATHS)
    truth = [light.total for light in layer.light(directions)]
    ours = known.fitted.interpolant.hemispherical(directions * FRONT)
    incidents = known.measurement.incidents
    on_line = np.abs(incidents[:, 0]) < 1e-6
    at = np.degrees(np.arcsin(incidents[on_line, 1]))
    order = np.argsort(at)
    figure = Figure(figsize=(8, 4), layout="constrained")
    axes = figure.subplots()
    axes.plot(theta, truth, "k-", lw=1, label="truth, every degree")
    axes.plot(at[order], known.known[on_line][order], "C7--", label="straight lines")
    axes.plot(theta, ours, "C0-", label="interpolant of 81 scans")
    axes.plot(at, known.known[on_line], "ko", ms=4, label="scans")
    axes.set(xlabel="profile angle [°]", ylabel="share of light transmitted")
    axes.legend(fontsize="small")
    return figure
