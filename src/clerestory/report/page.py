"""Report of a run as one self-contained HTML page.

Style, scripts, pictures and data are embedded. The content security policy blocks
everything else, including scripts injected by names or paths.
"""

from pathlib import Path

from clerestory.files import write_text
from clerestory.report.annual_sections import annual_sections
from clerestory.report.content import ReportContent
from clerestory.report.content_from_results import from_results
from clerestory.report.headline import headline
from clerestory.report.main_sections import (
    accuracy_section,
    computation_section,
    glossary_section,
    plans_section,
    room_section,
    year_section,
)
from clerestory.report.markup import element, join
from clerestory.report.page_assets import asset, render_page
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
    """Write the report of a run as one self-contained HTML file.

    Parameters
    ----------
    results : results of the run
    path : path of the HTML file
    pictures : folder of the pictures of the run; default: a report without pictures

    Raises
    ------
    InputError : the results contain values that are not finite, or a picture is damaged
    OutputError : the file cannot be written
    """
    write_text(path, report_page(from_results(results, pictures=pictures)))


def picture_folder(folder: Path, results: Results) -> Path:
    """Return the picture folder of a run, for its last method if it has several."""
    own = folder / str(results.data.attrs.get("method", "")) / PICTURE_FOLDER
    return own if own.is_dir() else folder / PICTURE_FOLDER


# Possible sections of a page, and their titles in the table of contents
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
    ("accuracy", "Uncertainty"),
    ("making", "Computation"),
    ("words", "Glossary"),
)


def report_page(content: ReportContent) -> str:
    """Return the report as HTML."""
    sections = join(
        plans_section(content),
        year_section(content),
        annual_sections(content),
        layers_section(content.layers),
        room_section(content),
        accuracy_section(content),
        computation_section(content),
        glossary_section(content),
    )
    links = (
        element("a", words, href=f"#{identifier}")
        for identifier, words in _CONTENTS
        if f' id="{identifier}"' in sections
    )
    contents = element("nav", *links, class_="contents", aria_label="Contents")
    return render_page(
        title=f"{content.title} · daylight report",
        style=asset("style.css"),
        body=join(headline(content), contents, sections),
        data=page_data(content),
        scripts=_SCRIPTS,
    )
