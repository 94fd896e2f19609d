"""Scripts that are run in finished pages in Chromium."""

import re

from lxml import html


def probed(page, script):
    """A copy of the page with one more script, which its policy would forbid."""
    text = page.read_text(encoding="utf-8")
    text = re.sub(r"<meta http-equiv[^>]*>", "", text)
    copy = page.with_name(f"probe-{abs(hash(script))}.html")
    probe = (
        "const wait = setInterval(async () => {"
        " if (!document.documentElement.dataset.scripts) return;"
        f" clearInterval(wait); document.title = await (async () => {{ {script} }})();"
        " }, 50);"
    )
    copy.write_text(
        text.replace("</body>", f"<script>{probe}</script></body>"), "utf-8"
    )
    return copy


def ask(browse, page, script):
    """What a script run in the finished page returns, as text."""
    opened = html.document_fromstring(browse(probed(page, script), "--dump-dom"))
    return opened.xpath("string(//title)")
