"""Annual sections: window states, pictures, glare, sunlight, electric lighting."""

from functools import partial

import numpy as np
from jaxtyping import UInt8

from clerestory.glare.dgp import DGP
from clerestory.report.animation import Row, film_section
from clerestory.report.class_map import DayMap
from clerestory.report.content import ReportContent
from clerestory.report.electric_lighting import lamp_maps, lamps_section
from clerestory.report.equation_terms import equation_section
from clerestory.report.markup import Markup, join
from clerestory.report.method_table import methods_section
from clerestory.report.picture_strip import pictures_section
from clerestory.report.sunlight import sunlight_section
from clerestory.report.view_glare import (
    COLOURS,
    glare_maps,
    glare_note,
    glare_section,
)
from clerestory.report.window_states import (
    state_maps,
    states_note,
    states_section,
)

# Colour of frames without daylight
_DARK = "#eceef0"


def day_maps(content: ReportContent) -> list[DayMap]:
    """Return the annual maps of window states, glare and luminaire output."""
    maps = (state_maps(content.states), glare_maps(content.glare))
    return [*maps[0], *maps[1], *lamp_maps(content.lamps)]


def moment_note(content: ReportContent, view: str, step: int) -> str:
    """Return the glare of a view and the window states at a time step, in words."""
    words = (
        glare_note(content.glare, view, step),
        states_note(content.states, step),
    )
    return "; ".join(filter(None, words))


def annual_sections(content: ReportContent) -> Markup:
    """Return the annual sections for which the run has data."""
    times, occupied = content.times, content.occupied
    note = partial(moment_note, content)
    return join(
        states_section(content.states, times, occupied=occupied),
        film_section(content.film, times, note=note, rows=film_rows(content)),
        pictures_section(content.pictures, times, note=note),
        glare_section(content.glare, times, occupied=occupied),
        sunlight_section(content.sunlight),
        lamps_section(content.lamps, times, occupied=occupied),
        equation_section(content.terms, content.sensors, times, occupied=occupied),
        methods_section(content.methods),
    )


def film_rows(content: ReportContent) -> list[Row]:
    """Return the window states and the glare of each frame of the animation."""
    if content.film is None:
        return []
    steps = content.film.steps.tolist()
    rows = []
    for each in content.states:
        shades = _hexadecimal(each.colours())
        state = [int(each.state[step]) for step in steps]
        words = tuple(each.names[k] for k in state)
        rows.append(Row(each.window, words, tuple(shades[k] for k in state)))
    shades = _hexadecimal(COLOURS)
    for glare in content.glare:
        kind = DGP.category(glare.rated()[steps]).tolist()
        lit = np.isfinite(glare.dgp[steps]).tolist()
        words = tuple(
            f"{glare.dgp[step]:.2f}" if known else "–"
            for step, known in zip(steps, lit, strict=True)
        )
        colours = tuple(
            shades[k] if known else _DARK for k, known in zip(kind, lit, strict=True)
        )
        rows.append(Row(f"DGP {glare.view}", words, colours))
    return rows


def _hexadecimal(colours: UInt8[np.ndarray, "kind 3"]) -> list[str]:
    return ["#{:02x}{:02x}{:02x}".format(*rgb) for rgb in colours.tolist()]
