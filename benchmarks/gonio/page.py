"""What pages of these benchmarks share: their heads, numbers and small pictures."""

import datetime
import io
import platform
from importlib.metadata import version
from pathlib import Path

import numpy as np
from PIL import Image

REPOSITORY = Path(__file__).parents[2]
FIGURES = REPOSITORY / "docs" / "figures"
_COLOURS = 96


def head(title):
    """Lines at the top of a page."""
    return [
        f"# {title}",
        "",
        f"{datetime.datetime.now(datetime.UTC):%Y-%m-%d}, {platform.machine()}, Python"
        f" {platform.python_version()}, POT {version('POT')}, pyradiance"
        f" {version('pyradiance')}. Made by `benchmarks/gonio`.",
        "",
    ]


def spread(values, digits):
    """Median, ninth decile and largest of sizes."""
    sizes = np.abs(values)
    return " / ".join(f"{np.quantile(sizes, q):.{digits}f}" for q in (0.5, 0.9, 1))


def save(figure, name):
    """Write a figure, small: few colours are enough for it."""
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=62)
    few = Image.open(buffer).convert("RGB").quantize(_COLOURS)
    few.save(FIGURES / f"{name}.png", optimize=True)
