"""Table of the study file for the title block of the report."""

from typing import Annotated

from pydantic import Field

from clerestory.documents import Table
from clerestory.study.file_fields import InputFile
from clerestory.study.title_block import TitleBlock

Line = Annotated[
    str,
    Field(
        pattern=r"^[^\x00-\x1f\x7f]*$", max_length=200, description="one line of text"
    ),
]


class ReportTable(Table):
    """Title block of the report: texts, a logo and notes."""

    project: Line = ""
    client: Line = ""
    author: Line = ""
    logo: InputFile | None = Field(None, description="a PNG or JPEG file")
    notes: InputFile | None = Field(None, description="a Markdown file")

    def title_block(self) -> TitleBlock:
        """Return the title block, with the content of its files."""
        own = TitleBlock(self.project, self.client, self.author)
        return own.with_changes(logo=self.logo, notes=self.notes)
