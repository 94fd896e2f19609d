"""Extraction of tensor tree texts from a file before its XML is parsed.

Trees can have hundreds of megabytes of text, too much for an XML parser. Every text
that starts with a brace is replaced by its number in braces.
"""

import re
from bisect import bisect_left
from dataclasses import dataclass, field

_START = re.compile(rb"<ScatteringData(?:\s[^<>]*)?>\s*(?=\{)")
_NUMBER = re.compile(r"\s*\{(\d{1,9})\}\s*")


@dataclass(frozen=True)
class TreeTexts:
    """Extracted texts and their places.

    Attributes
    ----------
    texts : from the first brace to the next element
    first_line : line of each within the XML
    line_in_rest : line of its number in the remaining XML
    """

    texts: list[bytes] = field(default_factory=list)
    first_line: list[int] = field(default_factory=list)
    line_in_rest: list[int] = field(default_factory=list)

    def line(self, line_in_rest: int) -> int:
        """Line of the XML for a line of the remaining XML."""
        before = bisect_left(self.line_in_rest, line_in_rest)
        if not before:
            return line_in_rest
        last = before - 1
        end = self.first_line[last] + self.texts[last].count(b"\n")
        return line_in_rest - self.line_in_rest[last] + end

    def find(self, text: str | None) -> int | None:
        """Return which text was replaced by this number; None if it is no number."""
        match = _NUMBER.fullmatch(text or "")
        return int(match[1]) if match and int(match[1]) < len(self.texts) else None


def cut_trees(data: bytes) -> tuple[bytes, TreeTexts]:
    """Return XML without the texts of its tensor trees, and these.

    >>> rest, trees = cut_trees(b"<ScatteringData>{ 0.3 }</ScatteringData>")
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
