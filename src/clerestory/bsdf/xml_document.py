"""Secure XML parsing of BSDF files, without entities or network access.

The text of a tensor tree can exceed the size limit of the XML parser. Before parsing,
every text that starts with a brace is therefore replaced by an index, such as {0}.
"""

import re
from bisect import bisect_left
from collections import Counter
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from lxml import etree

from clerestory.array_types import Values
from clerestory.bsdf.tree_scanner import parse_numbers
from clerestory.errors import InputError
from clerestory.files import read_bytes

_START = re.compile(rb"<ScatteringData(?:\s[^<>]*)?>\s*(?=\{)")
_NUMBER = re.compile(r"\s*\{(\d{1,9})\}\s*")

# Largest tolerated flux of negative BSDF values, as a fraction of the incident flux.
_NEGLIGIBLE = 1e-3

# Largest number in a file; larger ones overflow when multiplied
_LARGEST = 1e15


@dataclass(frozen=True)
class TreeTexts:
    """Texts of tensor trees extracted from an XML file, with their line numbers."""

    # Texts from the first brace to the next tag
    texts: list[bytes] = field(default_factory=list)
    # Line of the original XML where each text starts
    first_line: list[int] = field(default_factory=list)
    # Line of the shortened XML that contains the index of each text
    line_in_rest: list[int] = field(default_factory=list)

    def line(self, line_in_rest: int) -> int:
        """Line of the original XML that corresponds to a line of the shortened XML."""
        before = bisect_left(self.line_in_rest, line_in_rest)
        if not before:
            return line_in_rest
        last = before - 1
        end = self.first_line[last] + self.texts[last].count(b"\n")
        return line_in_rest - self.line_in_rest[last] + end

    def find(self, text: str | None) -> int | None:
        """Index of a tree text from a placeholder such as {0}; None for other texts."""
        match = _NUMBER.fullmatch(text or "")
        return int(match[1]) if match and int(match[1]) < len(self.texts) else None


def extract_trees(data: bytes) -> tuple[bytes, TreeTexts]:
    """Extract the texts of tensor trees from XML; return shortened XML and texts.

    >>> rest, trees = extract_trees(b"<ScatteringData>{ 0.3 }</ScatteringData>")
    >>> rest, trees.texts
    (b'<ScatteringData>{0}</ScatteringData>', [b'{ 0.3 }'])
    """
    trees = TreeTexts()
    rest: list[bytes] = []
    done, line, line_in_rest = 0, 1, 1
    for match in _START.finditer(data):
        start, end = match.end(), data.find(b"<", match.end())
        end = len(data) if end < 0 else end
        if start < done:
            continue
        passed = data.count(b"\n", done, start)
        line, line_in_rest = line + passed, line_in_rest + passed
        trees.texts.append(data[start:end])
        trees.first_line.append(line)
        trees.line_in_rest.append(line_in_rest)
        rest += [data[done:start], b"{%d}" % (len(trees.texts) - 1)]
        line += trees.texts[-1].count(b"\n")
        done = end
    return b"".join([*rest, data[done:]]), trees


@dataclass(frozen=True, eq=False)
class Document:
    """A parsed BSDF file."""

    path: str | Path  # path of the file, for error messages
    root: etree._Element  # root element
    lines_before: int = 0  # number of lines before the start of the XML
    notes: list[str] = field(default_factory=list)  # irregularities of the file
    # Extracted texts of tensor trees
    trees: TreeTexts = field(default_factory=TreeTexts)

    def line(self, element: etree._Element) -> int:
        """Line number of an element in the file."""
        return self.trees.line(int(element.sourceline or 0)) + self.lines_before

    def error(self, element: etree._Element, message: str) -> InputError:
        """Input error with the file and the line of an element."""
        return InputError(message, file=self.path, line=self.line(element))

    def check(self, valid: object, element: etree._Element, message: str) -> None:
        """Raise an input error at an element unless a condition is true."""
        if not valid:
            raise self.error(element, message)

    def note(self, element: etree._Element, text: str) -> None:
        """Note an irregularity at an element."""
        self.notes.append(f"line {self.line(element)}: {text}")

    def accept_negative(self, lost: float, element: etree._Element) -> None:
        """Note negative BSDF values of small flux; raise InputError for a larger flux.

        `lost`: flux of negative BSDF values, as a fraction of the incident flux.
        """
        message = f"negative values contain {lost:.2%} of the flux; a BSDF without"
        self.check(lost <= _NEGLIGIBLE, element, f"{message} negative values expected")
        if lost > 0:
            values = f"negative values, {lost:.1e} of the flux,"
            self.note(element, f"{values} are read as zero")

    def children(self, element: etree._Element, name: str) -> list[etree._Element]:
        """Child elements with a given name, in any namespace."""
        return list(element.iterfind(f"{{*}}{name}"))

    def find(self, element: etree._Element, path: str) -> etree._Element | None:
        """First descendant along a path of element names such as "Optical/Layer"."""
        return element.find("/".join(f"{{*}}{name}" for name in path.split("/")))

    def require(self, element: etree._Element, path: str) -> etree._Element:
        """First descendant along a path of element names; InputError if missing."""
        found = self.find(element, path)
        if found is None:
            raise self.error(element, f"no {path} in {_name(element)}; one expected")
        return found

    def refuse_repeated(self, element: etree._Element, *, but: str = "") -> None:
        """Raise an input error if an element has two children of one name."""
        names = Counter(_name(child) for child in element.iterchildren(etree.Element))
        twice = next((n for n, count in names.items() if count > 1 and n != but), "")
        message = f"{_name(element)} has {names[twice]} elements {twice}; one expected"
        self.check(not twice, element, message)

    def text(self, element: etree._Element, path: str) -> str:
        """Text of the first descendant along a path of element names; "" if missing."""
        found = self.find(element, path)
        return "" if found is None else (found.text or "").strip()


def parse_document(path: str | Path) -> Document:
    """Parse a BSDF file with the root element WindowElement.

    Text before the XML (the "Recover using:" line of genBSDF) is skipped and noted.
    Document type declarations are rejected: they allow entity expansion attacks.
    """
    data = read_bytes(path)
    start = re.search(rb"<\?xml|<WindowElement", data)
    if start is None:
        message = "no XML element WindowElement; a BSDF file expected"
        raise InputError(message, file=path)
    before = data[: start.start()].removeprefix(b"\xef\xbb\xbf").strip()
    lines_before = data[: start.start()].count(b"\n")
    parser = etree.XMLParser(
        resolve_entities=False, no_network=True, load_dtd=False, huge_tree=False
    )
    text, trees = extract_trees(data[start.start() :])
    try:
        root = etree.fromstring(text, parser)
    except etree.XMLSyntaxError as error:
        line = trees.line(error.lineno or 1) + lines_before
        reason = (error.msg or "unreadable").splitlines()[0]
        raise InputError(
            f"not well-formed XML: {reason}; a complete BSDF file expected",
            file=path,
            line=line,
        ) from error
    except (etree.LxmlError, ValueError, LookupError) as error:
        raise InputError(
            f"unreadable XML: {error}; a BSDF file expected", file=path
        ) from error
    document = Document(path, root, lines_before, trees=trees)
    if before:
        skipped = " ".join(before.decode("latin-1").split())[:60]
        document.notes.append(f"text before the XML is skipped: {skipped!r}")
    message = "the file has a DOCTYPE declaration; plain XML without it expected"
    document.check(not root.getroottree().docinfo.doctype, root, message)
    message = f"root element is {_name(root)}; WindowElement expected"
    document.check(_name(root) == "WindowElement", root, message)
    return document


def read_numbers(element: etree._Element, document: Document) -> Values:
    """Finite numbers of an element, separated by white space or commas."""
    text = (element.text or "").replace(",", " ")
    try:
        values = parse_numbers(text)
    except ValueError as error:
        word = next((word for word in text.split() if not is_number(word)), "")
        message = f"{word[:40]!r} in {_name(element)}; numbers expected"
        raise document.error(element, message) from error
    wrong = np.flatnonzero(~(np.abs(values) <= _LARGEST))
    if len(wrong):
        value = values[wrong[0]]
        found = f"value {wrong[0] + 1} of {_name(element)} is {value:g}"
        limit = f"a number up to {_LARGEST:.0e}"
        wanted = limit if np.isfinite(value) else "a finite number"
        raise document.error(element, f"{found}; {wanted} expected")
    return values


def is_number(word: str) -> bool:
    """Whether a word is a number, finite or not."""
    with suppress(ValueError):
        float(word)
        return True
    return False


def _name(element: etree._Element) -> str:
    return str(etree.QName(element).localname)
