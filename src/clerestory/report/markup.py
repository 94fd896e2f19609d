"""HTML and SVG put together from values, with user text escaped by default.

`Markup` marks text that is ready for the page. A plain string is the user's and
is escaped on its way in, so that no title or path can become a tag.
"""

import json
from html import escape
from typing import Any


class Markup(str):
    """Text that is already markup."""

    __slots__ = ()


def element(tag: str, *children: object, **attributes: object) -> Markup:
    """Return an element; plain text among its children is escaped.

    A trailing underscore in an attribute's name falls away, other underscores
    become hyphens. Attributes that are None are left out.

    >>> element("p", "a < b", class_="note")
    '<p class="note">a &lt; b</p>'
    """
    opening = tag
    for name, value in attributes.items():
        if value is not None:
            shown = name.rstrip("_").replace("_", "-")
            opening += f' {shown}="{escape(str(value))}"'
    return Markup(f"<{opening}>{join(*children)}</{tag}>")


def join(*children: object) -> Markup:
    """Return the children one after the other, plain text escaped."""
    return Markup(
        "".join(
            child if isinstance(child, Markup) else escape(str(child))
            for child in children
        )
    )


def embedded_json(identifier: str, value: Any) -> Markup:
    """Return a script element that holds data; no string in it can close it."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return element("script", Markup(text), type="application/json", id=identifier)
