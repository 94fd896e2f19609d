"""What a page needs to open offline: its parts, and a policy that forbids the rest."""

import base64
import hashlib
from importlib import resources


def asset(name: str) -> str:
    """Return the text of a file in the package's folder of scripts and styles."""
    folder = resources.files("clerestory.report") / "assets"
    return (folder / name).read_text(encoding="utf-8")


def content_policy(script: str) -> str:
    """Return the content policy that lets one script run and nothing be loaded.

    >>> content_policy("")[:19]
    "default-src 'none';"
    """
    digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
    return (
        "default-src 'none'; style-src 'unsafe-inline'; img-src data:;"
        f" script-src 'sha256-{digest}'"
    )
