"""The top of the page: what was studied, what came out, how sure it is."""

from clerestory.glare.comfort_classes import glare_autonomy
from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX
from clerestory.report.content import ReportContent
from clerestory.report.markup import Markup, element
from clerestory.report.metric_maps import MetricMap, metric_maps, useful_share
from clerestory.report.orientation import orientation
from clerestory.report.period import hours_in, period_words
from clerestory.report.uncertain_value import Figure
from clerestory.report.uncertainty import error_words

_METHODS = {
    "2-phase": "Two-phase method: daylight coefficients",
    "3-phase": "Three-phase method: view, transmission, daylight and sky matrices",
    "5-phase": "Five-phase method: three phases, with the direct sun at its true place",
}


def headline(content: ReportContent) -> Markup:
    """Return the title, the key figures of the first grid, and their accuracy."""
    maps = {metric.key: metric for metric in metric_maps(content.metrics)}
    places = (content.place, period_words(content.times))
    return element(
        "header",
        element("p", "Clerestory · annual daylight", class_="maker"),
        element("h1", content.title),
        element("p", _METHODS.get(content.method, content.method), class_="where"),
        element("p", " · ".join(filter(None, places)), class_="where"),
        element("p", lead_words(content), class_="lead"),
        warnings_box(content),
        _key_figures(content, maps),
        element(
            "p",
            error_words(content),
            " The ± of a mean is cautious: it supposes that the errors of all hours"
            " and sensors go the same way.",
            class_="note",
        ),
        _grid_table(content, maps),
    )


def lead_words(content: ReportContent) -> str:
    """Return the result of the first grid in one or two sentences."""
    maps = {metric.key: metric for metric in metric_maps(content.metrics)}
    grid, members = next(iter(content.sensors.by_grid().items()))
    who = f"the {len(members):,} sensors of “{grid}” receive"
    if len(members) == 1:
        who = f"the sensor “{content.sensors.names[members[0]]}” receives"
    schedule = content.schedule[:1].upper() + content.schedule[1:]
    return (
        f"{schedule}, {who} {maps['mean'].mean(members)} on average."
        f" Daylight alone gives {target_words(content)} or more in"
        f" {maps['autonomy'].mean(members)} of these"
        f" {hours_in(content.times, content.occupied):,.0f} hours."
        f"{_glare_words(content)}"
    )


def _glare_words(content: ReportContent) -> str:
    # Of several views the one with most glare
    if not content.glare:
        return ""
    use = content.occupied
    worst = min(content.glare, key=lambda view: glare_autonomy(view.rated()[use]))
    share = 100 * (1 - float(glare_autonomy(worst.rated()[use])))
    where = f"At “{worst.view}”" if len(content.glare) == 1 else "In the worst view"
    name = "" if len(content.glare) == 1 else f", “{worst.view}”,"
    return f" {where}{name} glare is disturbing in {share:.1f} % of them."


def target_words(content: ReportContent) -> str:
    """Return the target of daylight autonomy, such as "300 lux"."""
    return f"{float(content.metrics.attrs.get('target_lux', 300)):,.0f} lux"


def warnings_box(content: ReportContent) -> Markup:
    """Return what the reader should doubt, if anything."""
    doubts = [
        f"Window “{row.window}”: {row.doubt}"
        for row in (orientation(window, content) for window in content.windows)
        if row.doubt
    ]
    warnings = (*doubts, *dict.fromkeys(content.warnings))
    if not warnings:
        return Markup("")
    items = (element("li", warning) for warning in warnings)
    heading = element("h2", "Please check")
    return element("section", heading, element("ul", *items), class_="warnings")


def _key_figures(content: ReportContent, maps: dict[str, MetricMap]) -> Markup:
    members = next(iter(content.sensors.by_grid().values()))
    low, _, high = (f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX)
    figures: tuple[tuple[str, Figure, str], ...] = (
        ("Mean illuminance", maps["mean"].mean(members), maps["mean"].note),
        ("Daylight autonomy", maps["autonomy"].mean(members), maps["autonomy"].note),
        (
            "Useful illuminance",
            useful_share(content.metrics, members),
            f"hours from {low} to {high} lux",
        ),
        (
            "Too bright",
            maps["exceeded"].mean(members),
            f"hours with {high} lux or more",
        ),
    )
    items = []
    for title, figure, note in figures:
        value, _, rest = str(figure).partition(" ")
        items.append(
            element(
                "div",
                element("dt", title),
                element("dd", value, " ", element("small", rest)),
                element("dd", note, class_="about"),
            )
        )
    return element("dl", *items, class_="key-figures")


def _grid_table(content: ReportContent, maps: dict[str, MetricMap]) -> Markup:
    grids = content.sensors.by_grid()
    if len(grids) < 2:
        return Markup("")
    head = (
        "Grid",
        "Sensors",
        "Mean illuminance",
        "Daylight autonomy",
        "Useful illuminance",
        "Too bright",
    )
    rows = []
    for name, members in grids.items():
        cells = (
            f"{len(members):,}",
            maps["mean"].mean(members),
            maps["autonomy"].mean(members),
            useful_share(content.metrics, members),
            maps["exceeded"].mean(members),
        )
        label = element("th", name, scope="row")
        rows.append(element("tr", label, *(element("td", cell) for cell in cells)))
    titles = (element("th", title, scope="col") for title in head)
    table = element(
        "table",
        element("thead", element("tr", *titles)),
        element("tbody", *rows),
        class_="numbers",
    )
    return element("div", table, class_="wide")
