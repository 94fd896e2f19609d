"""The study's facts as tables: parameters, run times, every sensor."""

from collections.abc import Mapping, Sequence

from clerestory.report.content import FactTable
from clerestory.report.markup import Markup, element
from clerestory.report.metric_maps import MetricMap
from clerestory.report.sensor_points import SensorPoints
from clerestory.report.uncertain_value import Figure

_MOST_ROWS = 500


def fact_tables(tables: Sequence[FactTable]) -> Markup:
    """Return titled lists of labels and values side by side."""
    blocks = []
    for table in tables:
        rows = [
            element("tr", element("th", label, scope="row"), element("td", value))
            for label, value in table.rows
        ]
        body = element("table", element("tbody", *rows), class_="facts")
        blocks.append(element("div", element("h3", table.title), body))
    return element("div", *blocks, class_="fact-tables")


def time_table(seconds: Mapping[str, float]) -> Markup:
    """Return the run time of each phase, with bars, the longest first."""
    total = sum(seconds.values())
    rows = []
    for phase, spent in sorted(seconds.items(), key=lambda item: -item[1]):
        share = 100 * spent / total if total > 0 else 0.0
        bar = element("span", style=f"width:{share:.1f}%", class_="bar")
        cells = (
            element("th", phase, scope="row"),
            element("td", duration(spent)),
            element("td", bar, class_="track", aria_hidden="true"),
        )
        rows.append(element("tr", *cells))
    whole = (element("th", "Total", scope="row"), element("td", duration(total)))
    rows.append(element("tr", *whole, element("td")))
    return element("table", element("tbody", *rows), class_="times")


def duration(seconds: float) -> str:
    """Return a time span as people say it.

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


def sensor_table(sensors: SensorPoints, maps: Sequence[MetricMap]) -> Markup:
    """Return every sensor with its metrics, the first five hundred of many."""
    head = ["Sensor", "x [m]", "y [m]", "z [m]"]
    head += [f"{short_title(metric)} [{metric.unit}]" for metric in maps]
    rows = []
    for k in range(min(len(sensors), _MOST_ROWS)):
        cells = [f"{x:.2f}" for x in sensors.position[k]]
        for metric in maps:
            figure = Figure(float(metric.values[k]), float(metric.errors[k]), "")
            cells.append(str(figure).strip() if figure.error else f"{figure.value:.1f}")
        name = element("th", sensors.names[k], scope="row")
        rows.append(element("tr", name, *(element("td", cell) for cell in cells)))
    titles = (element("th", title, scope="col") for title in head)
    table = element(
        "table",
        element("thead", element("tr", *titles)),
        element("tbody", *rows),
        class_="numbers",
    )
    left = len(sensors) - len(rows)
    more = f" The other {left:,} are in the CSV files of the run." if left else ""
    summary = element("summary", f"Table of the sensors ({len(rows):,})")
    note = element("p", more.strip(), class_="note")
    return element("details", summary, element("div", table, class_="wide"), note)


def short_title(metric: MetricMap) -> str:
    """Return the title of a metric as the head of a column."""
    return metric.title.replace("Useful illuminance:", "UDI")
