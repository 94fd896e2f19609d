"""Self-contained HTML pages with embedded style, scripts and data."""

import base64
import hashlib
from collections.abc import Sequence
from importlib import resources
from typing import Any

import clerestory
from clerestory.report.markup import Markup, embedded_json, render


def asset(name: str) -> str:
    """Return the text of a script or style sheet of the package."""
    folder = resources.files("clerestory.report") / "assets"
    return (folder / name).read_text(encoding="utf-8")


def content_policy(script: str, *, served: bool = False) -> str:
    """Return a content security policy that permits only `script`, and no files.

    A page that is `served` may read values and pictures from its own server.

    >>> content_policy("")[:19]
    "default-src 'none';"
    """
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    images = "img-src data: 'self'; connect-src 'self'" if served else "img-src data:"
    return (
        f"default-src 'none'; style-src 'unsafe-inline'; {images};"
        f" script-src 'sha256-{digest}'"
    )


def render_page(
    *,
    title: str,
    style: str,
    body: Markup,
    data: Any,
    scripts: Sequence[str],
    served: bool = False,
) -> str:
    """Return an HTML page with embedded style, data and scripts.

    A page that is `served` may read values and pictures from its own server.
    """
    script = Markup("\n".join(asset(name) for name in scripts))
    return render(
        "page.html",
        version=clerestory.__version__,
        policy=content_policy(script, served=served),
        served=served,
        title=title,
        style=Markup(style),
        body=body,
        data=embedded_json("data", data),
        script=script,
    )
