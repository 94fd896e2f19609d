"""The end of the page: how sure, how computed, and what the words mean."""

from clerestory.metrics.climate_based_metrics import USEFUL_LIMITS_LUX
from clerestory.report.content import ReportContent
from clerestory.report.fact_tables import fact_tables, time_table
from clerestory.report.headline import target_words
from clerestory.report.markup import Markup, element
from clerestory.report.uncertainty import LIT_LUX, error_histogram, error_table


def accuracy_section(content: ReportContent) -> Markup:
    """Return the distribution of the standard errors."""
    return element(
        "section",
        element("h2", "How sure the numbers are"),
        element(
            "p",
            "Light paths are drawn at random, so every number has a standard error: two"
            " thirds of all runs with other seeds would lie within one of it. It says"
            " nothing of what the model leaves out."
            f" Values up to {LIT_LUX:.0f} lux are not counted here.",
            class_="note",
        ),
        element(
            "div",
            error_histogram(content),
            element("div", error_table(content), class_="wide"),
            class_="pair",
        ),
        id="accuracy",
    )


def making_section(content: ReportContent) -> Markup:
    """Return the parameters, versions and run times."""
    times = (
        (element("h3", "Run time"), time_table(content.seconds))
        if content.seconds
        else ()
    )
    return element(
        "section",
        element("h2", "How it was computed"),
        fact_tables(content.tables),
        *times,
        id="making",
    )


def words_section(content: ReportContent) -> Markup:
    """Return what the words mean."""
    low, middle, high = (f"{limit:,.0f}" for limit in USEFUL_LIMITS_LUX)
    words = (
        (
            "Occupied hours",
            f"The time steps that count for the metrics: {content.schedule}.",
        ),
        (
            "Mean illuminance",
            "Light that falls on the sensor’s plane, averaged over the occupied hours.",
        ),
        (
            "Daylight autonomy (DA)",
            "Share of the occupied hours in which daylight alone gives"
            f" {target_words(content)} or more.",
        ),
        (
            "Useful daylight illuminance (UDI)",
            f"Share of the occupied hours from {low} to {high} lux. Below, daylight"
            f" fell short; up to {middle} lux it is supplementary, with lamps beside"
            " it; from there on it is autonomous; above the range it is exceeded, and"
            " may dazzle or heat.",
        ),
        (
            "Standard error (±)",
            "How far the result would scatter over many runs with other seeds, found"
            " from independent batches of light paths.",
        ),
        (
            "Front of a window",
            "The side that its normal points to. Seen from there, the corners of its"
            " polygon run anticlockwise. It must be the room’s side.",
        ),
        (
            "BSDF’s up",
            "The direction in the plane of the window that was up when the BSDF was"
            " measured or computed. It decides which way slats tilt.",
        ),
    )
    items = (
        element("div", element("dt", word), element("dd", meaning))
        for word, meaning in words
    )
    heading = element("h2", "What the words mean")
    words_list = element("dl", *items, class_="words")
    return element("section", heading, words_list, id="words")
