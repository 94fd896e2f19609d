"""Sections of every report: room, uncertainty, computation, glossary."""

from collections.abc import Mapping

from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX
from clerestory.report.colour import illuminance_scale
from clerestory.report.content import ReportContent
from clerestory.report.headline import target_words
from clerestory.report.markup import Markup, render
from clerestory.report.metric_maps import metric_maps
from clerestory.report.orientation import orientation
from clerestory.report.room_view import MOST_TRIANGLES, room_view
from clerestory.report.section import Section
from clerestory.report.uncertainty import LIT_LUX, error_histogram, error_rows

# Legend of the 3-D view, with the same colours as in view.js
_KEYS = (
    ("#2f8f5b", "front of a window, and its normal: must face the room"),
    ("#d9772b", "back of a window: must face outdoors"),
    ("#6a3d9a", "up direction of the BSDF"),
    ("#b5367a", "sensors, coloured by their mean illuminance as in the plans"),
)


def room_section(content: ReportContent) -> Section:
    """Return the 3-D view and a description of the window orientations."""
    rows = [orientation(window, content) for window in content.windows]
    faces = "; ".join(f"window {row.window} faces {row.room_side}" for row in rows)
    body = render(
        "room.html",
        label=f"3-D view of the scene with {len(content.sensors)} sensors. {faces}",
        colours=_KEYS,
        left_out=len(content.room.corners) - MOST_TRIANGLES,
        windows=rows,
    )
    means = metric_maps(content.metrics)[0].values
    view = room_view(content, means=means, scale=illuminance_scale(means))
    return Section(body, {"view": view})


def accuracy_section(content: ReportContent) -> Section:
    """Return the section on uncertainty: relative standard errors of illuminance."""
    histogram, rows = error_histogram(content), error_rows(content)
    least = f"{LIT_LUX:.0f}"
    return Section(render("accuracy.html", least=least, histogram=histogram, rows=rows))


def computation_section(content: ReportContent) -> Section:
    """Return the section with parameters, versions and run times."""
    times = time_table(content.seconds) if content.seconds else ""
    return Section(render("computation.html", tables=content.tables, times=times))


def time_table(seconds: Mapping[str, float]) -> Markup:
    """Return the run time of each phase of the simulation as bars, longest first."""
    total = sum(seconds.values())
    rows = [
        (phase, duration(spent), 100 * spent / total if total > 0 else 0.0)
        for phase, spent in sorted(seconds.items(), key=lambda item: -item[1])
    ]
    return render("times.html", rows=rows, total=duration(total))


def duration(seconds: float) -> str:
    """Return a duration [s] as text with units.

    >>> duration(0.0314), duration(12.34), duration(754)
    ('0.03 s', '12.3 s', '12 min 34 s')
    """
    if seconds < 1:
        return f"{seconds:.2f} s"
    if seconds < 120:
        return f"{seconds:.1f} s"
    minutes, rest = divmod(round(seconds), 60)
    if minutes < 120:
        return f"{minutes} min {rest} s"
    return f"{minutes // 60} h {minutes % 60} min"


def glossary_section(content: ReportContent) -> Section:
    """Return the glossary of daylight metrics."""
    return Section(
        render(
            "glossary.html",
            schedule=content.schedule,
            target=target_words(content),
            limits=[f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX],
        )
    )
