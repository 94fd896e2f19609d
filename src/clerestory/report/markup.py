"""HTML and SVG markup by Jinja2 templates and element functions.

All text is escaped unless it is `Markup`, so that titles and paths cannot inject tags.
"""

import json
from functools import cache
from typing import Any

from jinja2 import Environment, PackageLoader, StrictUndefined
from markupsafe import Markup, escape

__all__ = ["Markup", "drawing", "element", "embedded_json", "join", "render"]


@cache
def _templates() -> Environment:
    return Environment(
        loader=PackageLoader("clerestory.report"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )


def render(template: str, **values: object) -> Markup:
    """Return a template of the package, rendered with the given values."""
    return Markup(_templates().get_template(template).render(**values))


def element(tag: str, *children: object, **attributes: object) -> Markup:
    """Return an HTML or SVG element; children that are plain text are escaped.

    In attribute names a trailing underscore is removed, and other underscores become
    hyphens. Attributes that are None are left out.

    >>> print(element("p", "a < b", class_="note"))
    <p class="note">a &lt; b</p>
    """
    opening = tag
    for name, value in attributes.items():
        if value is not None:
            shown = name.rstrip("_").replace("_", "-")
            opening += f' {shown}="{escape(str(value))}"'
    return Markup(f"<{opening}>{join(*children)}</{tag}>")


def drawing(
    label: str, *children: object, width: float, height: float, **attributes: object
) -> Markup:
    """Return an SVG drawing with a label for screen readers."""
    return element(
        "svg",
        element("title", label),
        *children,
        viewBox=f"0 0 {width:.0f} {height:.0f}",
        role="img",
        aria_label=label,
        **attributes,
    )


def join(*children: object) -> Markup:
    """Return markup and plain text, concatenated; plain text is escaped."""
    return Markup("").join(escape(child) for child in children)


def embedded_json(identifier: str, value: Any) -> Markup:
    """Return a script element with JSON data; no string in it can close the element."""
    text = json.dumps(value, ensure_ascii=False, separators=(",", ":"), allow_nan=False)
    for sign in "<>&\u2028\u2029":
        text = text.replace(sign, f"\\u{ord(sign):04x}")
    return element("script", Markup(text), type="application/json", id=identifier)
