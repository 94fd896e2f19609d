"""The page as a whole: what stands where, in which words.

The page asks nothing of the network: style, scripts, pictures and data are in
it, and its content policy forbids everything else, scripts that came in with a
name or a path included.
"""

from pathlib import Path
from string import Template

import clerestory
from clerestory.files import write_text
from clerestory.report.annual_sections import course_sections
from clerestory.report.appendix import (
    accuracy_section,
    making_section,
    words_section,
)
from clerestory.report.content import ReportContent
from clerestory.report.content_from_results import from_results
from clerestory.report.headline import headline
from clerestory.report.main_sections import plans_section, room_section, year_section
from clerestory.report.markup import Markup, element, embedded_json, join
from clerestory.report.page_assets import asset, content_policy
from clerestory.report.page_data import page_data
from clerestory.report.window_layers import layers_section
from clerestory.study.annual_views import PICTURE_FOLDER
from clerestory.study.results import Results

REPORT_FILE = "report.html"

_SCRIPTS = (
    "raster.js",
    "solids.js",
    "plan.js",
    "year.js",
    "maps.js",
    "film.js",
    "terms.js",
    "view.js",
    "start.js",
)


def write_report(
    results: Results, path: str | Path, *, pictures: str | Path | None = None
) -> None:
    """Write the report of a run as one HTML file that opens anywhere, offline.

    Parameters
    ----------
    results : of the run
    path : the page
    pictures : folder that holds the run's pictures; without it the page has none

    Raises
    ------
    InputError : the results hold values that are not numbers, or a picture is damaged
    OutputError : the file cannot be written
    """
    write_text(path, report_page(from_results(results, pictures=pictures)))


def picture_folder(folder: Path, results: Results) -> Path:
    """Return the folder of a run's pictures; of several methods, that of the last."""
    own = folder / str(results.data.attrs.get("method", "")) / PICTURE_FOLDER
    return own if own.is_dir() else folder / PICTURE_FOLDER


# Sections that a page may have, and their names in the list of contents
_CONTENTS = (
    ("plans", "Plans"),
    ("year", "Year"),
    ("states", "States of windows"),
    ("film", "A day in pictures"),
    ("pictures", "Pictures"),
    ("glare", "Glare"),
    ("sunlight", "Sunlight"),
    ("lamps", "Electric light"),
    ("equation", "Direct correction"),
    ("methods", "Methods"),
    ("layers", "BSDFs"),
    ("room", "Room"),
    ("accuracy", "Accuracy"),
    ("making", "How computed"),
    ("words", "Words"),
)


def report_page(content: ReportContent) -> str:
    """Return the report as HTML."""
    sections = join(
        plans_section(content),
        year_section(content),
        course_sections(content),
        layers_section(content.layers),
        room_section(content),
        accuracy_section(content),
        making_section(content),
        words_section(content),
    )
    body = join(
        headline(content),
        _contents(sections),
        sections,
        element(
            "footer",
            f"Made by Clerestory {clerestory.__version__}. This file is complete: it"
            " opens without a network and loads nothing.",
        ),
        element("div", id="tip", aria_hidden="true"),
    )
    script = Markup("\n".join(asset(name) for name in _SCRIPTS))
    return Template(asset("page.html")).substitute(
        version=clerestory.__version__,
        policy=content_policy(script),
        title=join(content.title, " · daylight report"),
        style=asset("style.css"),
        body=body,
        data=embedded_json("data", page_data(content)),
        script=script,
    )


def _contents(sections: Markup) -> Markup:
    links = (
        element("a", words, href=f"#{identifier}")
        for identifier, words in _CONTENTS
        if f' id="{identifier}"' in sections
    )
    return element("nav", *links, class_="contents", aria_label="Contents")
