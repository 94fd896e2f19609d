"""Directions with large interpolation errors, and the effect of further scans there.

Films of prisms, 81 scans: leave-one-out prediction gives a map of errors. The page
counts the directions that the map flags, those with large errors, and those with large
errors after further scans at the recommended directions or evenly spread.
"""

from dataclasses import replace
from typing import NamedTuple

import numpy as np
from known_layers import FRONT, PATHS, SEED, fresh_directions
from matplotlib.figure import Figure
from page import head, save, spread
from straight_lines import folding, places

import traced_layer as traced
from clerestory.bsdfgen.film_geometry import prismatic
from clerestory.gonio.angles import angle_between
from clerestory.gonio.cross_validation import cross_validate
from clerestory.gonio.fitted_measurement import fit_measurement
from clerestory.gonio.measurement_planning import recommended_directions
from clerestory.gonio.scattering_measurement import Measurement
from goniometer import half_circle

ELSEWHERE = 0.3  # a scan of which others put more light elsewhere flags what is near
FLUX, TURN = 0.02, 2.0  # errors that fail: share of the light, angle of a beam [°]
MORE = (20, 80)


class Met(NamedTuple):
    """Errors at fresh directions: of flux, of the brightest and the worst beam [°]."""

    flux: np.ndarray
    brightest: np.ndarray
    worst: np.ndarray

    @property
    def failed(self):
        """Which directions fail."""
        return (np.abs(self.flux) > FLUX) | (self.worst > TURN)


def lines(_data):
    """Yield the page, and draw the map of both films."""
    yield from head("Measurements to BSDFs: where more scans are needed")
    yield (
        f"Errors at 60 directions that were not measured (seed {SEED}). A direction"
        " *fails* if the flux is wrong by more than 2 % of the light or a beam by"
        " more than 2°. It is *flagged* if it is next to a scan of which"
        f" leave-one-out prediction misplaces more than {ELSEWHERE:.0%} of the flux"
        " (`clerestory gonio check`). Further scans are at the directions that `gonio"
        " check --next` recommends, or spaced *evenly*. Flux and the brightest beam"
        " [°]: median / 9th"
        " decile / largest."
    )
    yield ""
    yield (
        "| layer | scans | flagged | fail | of these flagged | flux | over 2 % |"
        " brightest beam [°] | over 2° | a beam over 2° |"
    )
    yield "|---|---|---|---|---|---|---|---|---|---|"
    figure = Figure(figsize=(9, 4.4), layout="constrained")
    films = (
        ("prismatic film, 80° and 8°", {"upper_angle_deg": 80, "lower_angle_deg": 8}),
        ("prismatic film, 45°", {}),
    )
    for axes, (name, angles) in zip(figure.subplots(1, 2), films, strict=True):
        layer = traced.TracedLayer(prismatic(**angles), paths=PATHS)
        yield from film_rows(name, layer, axes)
    save(figure, "gonio-film-scans")


def film_rows(name, layer, axes):
    """Yield the rows of a film, and draw its map."""
    directions = fresh_directions()
    truth = layer.light(directions)
    first = half_circle()
    scans = traced.measure(first, layer.light(first), name=name)
    fitted = fit_measurement(scans)
    validation = cross_validate(scans)
    flagged = beside(fitted.interpolant, scans, validation, directions)
    met = errors(fitted.interpolant, directions, truth)
    yield row(name, "81", met, flagged)
    draw(axes, name, validation, scans, directions, met)
    level = tuple(replace(scan, misplaced=1.0) for scan in validation.scans)
    for words, map_ in (
        ("", validation),
        (" evenly", replace(validation, scans=level)),
    ):
        for count in MORE:
            where = recommended_directions(map_, symmetry=scans.symmetry, count=count)
            more = traced.measure(where, layer.light(where), seed=2).scans
            joined = Measurement((*scans.scans, *more), scans.function)
            after = fit_measurement(joined, symmetry=scans.symmetry)
            met = errors(after.interpolant, directions, truth)
            yield row(name, f"81 + {count}{words}", met)


def beside(interpolant, scans, validation, directions):
    """Which directions are next to a scan that is predicted badly."""
    share = np.array([scan.misplaced for scan in validation.scans])
    ends, _ = folding(interpolant, interpolant.network.mesh.vertices)
    own, _ = folding(interpolant, scans.incidents)
    share = share[angle_between(ends[:, None], own).argmin(axis=1)]
    folded, factors = folding(interpolant, directions)
    about = places(interpolant.network.mesh, folded, factors)
    return np.array([share[corners].max() > ELSEWHERE for corners, *_ in about])


def errors(interpolant, directions, truth):
    """Compare an interpolant with the truth."""
    found = map(traced.drawn, interpolant.lobes_of(directions * FRONT))
    pairs = list(zip(found, truth, strict=True))
    turns = [traced.turned_by(*pair) for pair in pairs]
    return Met(
        np.array([one.total - other.total for one, other in pairs]),
        np.array([turn[0] if len(turn) else 0.0 for turn in turns]),
        np.array([turn.max(initial=0) for turn in turns]),
    )


def row(name, scans, met, flagged=None):
    """Line of the table."""
    failed = met.failed
    cells = [
        scans,
        "" if flagged is None else f"{flagged.sum()}",
        f"{failed.sum()}",
        "" if flagged is None else f"{(failed & flagged).sum()}",
        spread(met.flux, 4),
        f"{np.sum(np.abs(met.flux) > FLUX)}",
        spread(met.brightest, 2),
        f"{np.sum(met.brightest > TURN)}",
        f"{np.sum(met.worst > TURN)}",
    ]
    return f"| {name} | {' | '.join(cells)} |"


def draw(axes, name, validation, scans, directions, met):
    """Draw what is put elsewhere of each scan, and which fresh directions fail."""
    share = np.clip([scan.misplaced for scan in validation.scans], 0, 1)
    where = recommended_directions(validation, symmetry=scans.symmetry, count=MORE[0])
    x, y = disc(scans.incidents)
    marks = axes.scatter(x, y, c=share, s=46, cmap="viridis", vmin=0, vmax=1)
    folded = directions * [np.sign(x.sum()), 1, 1]
    folded[:, 0] = np.abs(folded[:, 0]) * np.sign(x.sum())
    for which, style in ((met.failed, "rx"), (~met.failed, "k.")):
        axes.plot(*disc(folded[which]), style, ms=5)
    axes.plot(*disc(where), "o", ms=9, mfc="none", mec="tab:orange")
    axes.set(title=name, aspect="equal", xlim=(-4, 92), ylim=(-92, 92))
    axes.axis("off")
    bar = axes.figure.colorbar(marks, ax=axes, shrink=0.8)
    bar.set_label("share of a scan's light put elsewhere")


def disc(directions):
    """Angle to the normal [°] as distance from the middle."""
    theta = np.degrees(np.arccos(np.clip(directions[:, 2], -1, 1)))
    flat = np.maximum(np.hypot(*directions[:, :2].T), 1e-12)
    return directions[:, :2].T * (theta / flat)
