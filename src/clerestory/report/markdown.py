"""Markdown as HTML that is safe to embed in a report.

CommonMark with tables, by markdown-it. Raw HTML is shown as text, addresses of scripts
are not linked, and images are replaced by their text, since a report loads nothing.
"""

from functools import cache

from markdown_it import MarkdownIt

from clerestory.report.markup import Markup

# Heading level of "#" in notes: below the heading of the section
_LEVELS_DOWN = 2


@cache
def _parser() -> MarkdownIt:
    found = MarkdownIt("commonmark", {"html": False, "breaks": False})
    return found.enable("table")


def markdown(text: str) -> Markup:
    r"""Return a text in Markdown as HTML; its headings start at level 3.

    >>> print(markdown("# Result\n\nGlare is **rare**, <b>see</b> below."))
    <h3>Result</h3>
    <p>Glare is <strong>rare</strong>, &lt;b&gt;see&lt;/b&gt; below.</p>
    <BLANKLINE>
    """
    parser, environment = _parser(), dict[str, object]()
    tokens = parser.parse(text, environment)
    for token in tokens:
        if token.type in ("heading_open", "heading_close"):
            token.tag = f"h{min(int(token.tag[1]) + _LEVELS_DOWN, 6)}"
        for part in token.children or ():
            if part.type == "image":
                # The text in place of the image
                part.type, part.tag, part.children = "text", "", None
            if part.type == "link_open":
                part.attrSet("rel", "noopener noreferrer")
    made = parser.renderer.render(tokens, parser.options, environment)
    table = '<div class="wide"><table>'
    return Markup(made.replace("<table>", table).replace("</table>", "</table></div>"))
