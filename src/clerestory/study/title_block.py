"""Title block of a report: project, client, author, logo, and notes in Markdown.

It is part of the run data, `run.json`, so that a report can be written again without
the files of the study.
"""

import base64
import io
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

from PIL import Image

from clerestory.brief_repr import brief
from clerestory.checks import require
from clerestory.files import read_text
from clerestory.image.photograph import opened_image

# Largest width and height of a logo [pixels], and largest number of characters of notes
_LOGO_SIZE = (480, 240)
_MOST_NOTES = 100_000


@dataclass(frozen=True)
class TitleBlock:
    """Title block of a report.

    Attributes
    ----------
    project, client, author : one line of text each; empty if there is none
    logo : content of a PNG file; empty if there is none
    notes : text in Markdown

    Examples
    --------
    >>> TitleBlock(project="Library").with_changes(author="A. Bauer").project
    'Library'
    """

    project: str = ""
    client: str = ""
    author: str = ""
    logo: bytes = b""
    notes: str = ""

    __repr__ = brief

    def __bool__(self) -> bool:
        """Whether there is any content."""
        return any(asdict(self).values())

    def facts(self) -> dict[str, str]:
        """Return the content as JSON values, the logo in base64."""
        logo = base64.b64encode(self.logo).decode()
        return {name: text for name, text in {**asdict(self), "logo": logo}.items()}

    def with_changes(
        self,
        *,
        project: str | None = None,
        client: str | None = None,
        author: str | None = None,
        logo: str | Path | None = None,
        notes: str | Path | None = None,
    ) -> "TitleBlock":
        """Return a title block with other texts; `logo` and `notes` are files.

        Raises
        ------
        InputError : a file cannot be read, or is not a PNG or JPEG image
        """
        given: dict[str, Any] = {"project": project, "client": client, "author": author}
        given["logo"] = None if logo is None else read_logo(logo)
        given["notes"] = None if notes is None else read_notes(notes)
        return replace(self, **{k: v for k, v in given.items() if v is not None})


def title_block_of(run: Mapping[str, Any]) -> TitleBlock:
    """Return the title block in the run data; empty if there is none."""
    facts = {"logo": "", **dict(run.get("report", {}))}
    known = {k: v for k, v in facts.items() if k in TitleBlock.__dataclass_fields__}
    return TitleBlock(**{**known, "logo": base64.b64decode(facts["logo"])})


def read_logo(path: str | Path) -> bytes:
    """Return a PNG or JPEG file as content of a PNG file of at most 480 × 240 pixels.

    Transparent pixels become white.
    """
    with opened_image(path, kind="a PNG or JPEG image") as image:
        require(
            image.format in ("PNG", "JPEG"),
            f"an image in format {image.format}; PNG or JPEG expected",
            file=path,
        )
        image.thumbnail(_LOGO_SIZE, Image.Resampling.LANCZOS)
        clear = image.convert("RGBA")
        page = Image.new("RGBA", clear.size, "white")
        opaque = Image.alpha_composite(page, clear).convert("RGB")
    stream = io.BytesIO()
    opaque.save(stream, format="PNG", optimize=True)
    return stream.getvalue()


def read_notes(path: str | Path) -> str:
    """Return the text of a Markdown file."""
    text = read_text(path)
    require(
        len(text) <= _MOST_NOTES,
        f"has {len(text):,} characters; at most {_MOST_NOTES:,} expected",
        file=path,
    )
    return text
