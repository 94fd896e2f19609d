"""Hardened XML parsing: no entities, no network, line numbers for messages."""

import re
import warnings
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from lxml import etree

from clerestory.array_types import Values
from clerestory.bsdf.xml_tree_extraction import TreeTexts, cut_trees
from clerestory.errors import InputError
from clerestory.files import read_bytes


@dataclass(frozen=True, eq=False)
class Document:
    """A parsed file.

    Attributes
    ----------
    path : the file
    root : outermost element
    lines_before : lines of text before the XML
    notes : irregularities
    trees : extracted texts of tensor trees
    """

    path: str | Path
    root: etree._Element
    lines_before: int = 0
    notes: tuple[str, ...] = ()
    trees: TreeTexts = field(default_factory=TreeTexts)

    def line(self, element: etree._Element) -> int:
        """Line of the file on which an element starts."""
        seen = int(element.sourceline or 0)
        return self.trees.line(seen) + self.lines_before

    def error(self, element: etree._Element, message: str) -> InputError:
        """Return the error at an element."""
        return InputError(message, file=self.path, line=self.line(element))

    def children(self, element: etree._Element, name: str) -> list[etree._Element]:
        """Children of a name, in any namespace."""
        return list(element.iterfind(f"{{*}}{name}"))

    def find(self, element: etree._Element, path: str) -> etree._Element | None:
        """First descendant along a path of names such as "Optical/Layer"."""
        return element.find("/".join(f"{{*}}{name}" for name in path.split("/")))

    def require(self, element: etree._Element, path: str) -> etree._Element:
        """First descendant along a path of names; an InputError if there is none."""
        found = self.find(element, path)
        if found is None:
            raise self.error(element, f"no {path} in {_name(element)}; one expected")
        return found

    def text(self, element: etree._Element, path: str) -> str:
        """Text of the first descendant along a path, "" if there is none."""
        found = self.find(element, path)
        return "" if found is None else (found.text or "").strip()


def parse_document(path: str | Path) -> Document:
    """Return the WindowElement of a file.

    Text before the XML (genBSDF's "Recover using:" line) is skipped and noted. Document
    type declarations, which entity expansion attacks need, are refused.
    """
    data = read_bytes(path)
    start = re.search(rb"<\?xml|<WindowElement", data)
    if start is None:
        raise InputError(
            "no XML element WindowElement; a BSDF file expected", file=path
        )
    before = data[: start.start()].removeprefix(b"\xef\xbb\xbf").strip()
    lines_before = data[: start.start()].count(b"\n")
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False
    )
    text, trees = cut_trees(data[start.start() :])
    try:
        root = etree.fromstring(text, parser)
    except etree.XMLSyntaxError as error:
        line = trees.line(error.lineno or 1) + lines_before
        reason = (error.msg or "unreadable").splitlines()[0]
        raise InputError(
            f"not well-formed XML: {reason}; a whole BSDF file expected",
            file=path,
            line=line,
        ) from error
    except (etree.LxmlError, ValueError, LookupError) as error:
        raise InputError(f"not readable XML: {error}", file=path) from error
    notes = (f"text before the XML is skipped: {_quote(before)}",) if before else ()
    document = Document(path, root, lines_before, notes, trees)
    if root.getroottree().docinfo.doctype:
        raise document.error(
            root, "a DOCTYPE declaration; plain XML without it expected"
        )
    if _name(root) != "WindowElement":
        raise document.error(
            root, f"root element {_name(root)}; WindowElement expected"
        )
    return document


def read_numbers(element: etree._Element, document: Document) -> Values:
    """Finite numbers of an element, separated by white space or commas."""
    text = (element.text or "").replace(",", " ")
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("error", DeprecationWarning)
            values = np.fromstring(text, sep=" ")
    except (DeprecationWarning, ValueError) as error:
        word = next((word for word in text.split() if not _is_number(word)), "")
        raise document.error(
            element, f"{word[:40]!r} in {_name(element)}; numbers expected"
        ) from error
    if not np.all(np.isfinite(values)):
        at = int(np.argmin(np.isfinite(values)))
        raise document.error(
            element,
            f"value {at + 1} of {_name(element)} is {values[at]}; a number expected",
        )
    return values


def _is_number(word: str) -> bool:
    try:
        float(word)
    except ValueError:
        return False
    return True


def _name(element: etree._Element) -> str:
    return str(etree.QName(element).localname)


def _quote(data: bytes) -> str:
    text = " ".join(data.decode("latin-1").split())
    return repr(text if len(text) < 60 else text[:57] + "...")
