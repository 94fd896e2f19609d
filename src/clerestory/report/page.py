"""Report of a run as one self-contained HTML page.

Style, scripts, pictures and data are embedded. The content security policy blocks
everything else, including scripts injected by names or paths.
"""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

from clerestory.files import write_text
from clerestory.report.animation import film_section
from clerestory.report.compliance_section import compliance_sections
from clerestory.report.content import ReportContent
from clerestory.report.content_from_results import from_results
from clerestory.report.electric_lighting import lamps_section
from clerestory.report.energy_section import energy_section
from clerestory.report.equation_terms import equation_section
from clerestory.report.headline import headline
from clerestory.report.knowledge_section import knowledge_section
from clerestory.report.main_sections import (
    accuracy_section,
    computation_section,
    glossary_section,
    room_section,
)
from clerestory.report.markup import element, join
from clerestory.report.melanopic_section import melanopic_section
from clerestory.report.method_table import methods_section
from clerestory.report.notes_section import notes_section
from clerestory.report.page_assets import asset, render_page
from clerestory.report.picture_strip import pictures_section
from clerestory.report.plan_section import plans_section
from clerestory.report.section import Section
from clerestory.report.sensitivity_section import sensitivity_section
from clerestory.report.sunlight import sunlight_section
from clerestory.report.view_glare import glare_section
from clerestory.report.view_grids import view_grids_section
from clerestory.report.window_layers import layers_section
from clerestory.report.window_states import states_section
from clerestory.report.year_section import year_section
from clerestory.study.annual_views import PICTURE_FOLDER
from clerestory.study.results import Results
from clerestory.study.title_block import TitleBlock

REPORT_FILE = "report.html"

_SCRIPTS = (
    "raster.js",
    "solids.js",
    "plan.js",
    "year.js",
    "maps.js",
    "rosettes.js",
    "film.js",
    "terms.js",
    "view.js",
    "scroll_hints.js",
    "start.js",
)


def write_report(
    results: Results,
    path: str | Path,
    *,
    pictures: str | Path | None = None,
    title_block: TitleBlock | None = None,
) -> None:
    """Write the report of a run as one self-contained HTML file.

    `pictures` is the folder of the run's pictures; without it no pictures are shown.
    `title_block` replaces that of the study.
    """
    content = from_results(results, pictures=pictures)
    if title_block is not None:
        content = replace(content, title_block=title_block)
    write_text(path, report_page(content))


def picture_folder(folder: Path, results: Results) -> Path:
    """Return the picture folder of a run (of its last phase method, if several)."""
    own = folder / str(results.data.attrs.get("method", "")) / PICTURE_FOLDER
    return own if own.is_dir() else folder / PICTURE_FOLDER


# Sections of a report: HTML identifier, title in the table of contents, function
_SECTIONS: tuple[tuple[str, str, Callable[[ReportContent], Section]], ...] = (
    ("plans", "Plans", plans_section),
    ("year", "Year", year_section),
    ("melanopic", "Melanopic daylight", melanopic_section),
    ("states", "States of windows", states_section),
    ("film", "A day in pictures", film_section),
    ("pictures", "Pictures", pictures_section),
    ("glare", "Glare", glare_section),
    ("view-grids", "Glare at every position", view_grids_section),
    ("sunlight", "Sunlight", sunlight_section),
    ("sensitivity", "Sensitivity", sensitivity_section),
    ("lamps", "Electric light", lamps_section),
    ("energy", "Energy", energy_section),
    ("equation", "Direct correction", equation_section),
    ("methods", "Methods", methods_section),
    ("layers", "BSDFs", layers_section),
    ("room", "Room", room_section),
    ("knowledge", "What is not known", knowledge_section),
    ("accuracy", "Uncertainty", accuracy_section),
    ("making", "Computation", computation_section),
    ("words", "Glossary", glossary_section),
)


def report_page(content: ReportContent) -> str:
    """Return the report as HTML."""
    made = [
        ("notes", "Notes", notes_section(content)),
        *compliance_sections(content),
        *((name, title, make(content)) for name, title, make in _SECTIONS),
    ]
    links = (
        element("a", title, href=f"#{name}") for name, title, one in made if one.body
    )
    contents = element("nav", *links, class_="contents", aria_label="Contents")
    sections = [section for _, _, section in made]
    maps = {m.identifier: m.data(content.grid) for s in sections for m in s.maps}
    data: dict[str, Any] = {"names": list(content.sensors.names), "maps": maps}
    for section in sections:
        data |= section.data
    return render_page(
        title=f"{content.title} · daylight report",
        style=asset("style.css"),
        body=join(headline(content), contents, *(s.body for s in sections)),
        data=data,
        scripts=_SCRIPTS,
    )
