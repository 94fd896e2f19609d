"""Section of a report with the notes of its author."""

from clerestory.report.content import ReportContent
from clerestory.report.markdown import markdown
from clerestory.report.markup import render
from clerestory.report.section import Section


def notes_section(content: ReportContent) -> Section:
    """Return the notes as a section; empty without notes."""
    text = content.title_block.notes.strip()
    return Section(render("notes.html", text=markdown(text)) if text else "")
