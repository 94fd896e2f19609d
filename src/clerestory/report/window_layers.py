"""Window layers: angular distribution and transmittance."""

import io
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Float
from matplotlib.figure import Figure as Drawing

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems
from clerestory.report.bsdf_plot import (
    direction_from_angles,
    lobe_figure,
    share_figure,
)
from clerestory.report.embedded_data import png_address
from clerestory.report.markup import Markup, element, render

# Maximum numbers of layers drawn as discs and as curves; incident polar angle and
# azimuth [°]; resolution
_MOST_DISCS, _MOST = 5, 8
_SOURCES = ((0.0, 90.0), (45.0, 90.0))
_DPI = 80


@dataclass(frozen=True, eq=False)
class Layer:
    """A layer in a window.

    Attributes
    ----------
    name : name of the window and its state
    transmission : front transmission BSDF in the full Klems basis [1/sr]
    """

    name: str
    transmission: Float[np.ndarray, "exit incident"]

    def bsdf(self) -> Bsdf:
        """Return the layer as a BSDF."""
        patches = klems("full")
        part = ScatteringMatrix(self.transmission, patches, patches)
        return Bsdf({("visible", "transmission_front"): part}, Product(name=self.name))


def window_layers(data: xr.Dataset) -> tuple[Layer, ...]:
    """Return the layers in the results."""
    if "layer_transmission" not in data:
        return ()
    values = np.asarray(data["layer_transmission"].values, dtype=float)
    names = data["layer"].values.tolist()
    return tuple(Layer(str(n), v) for n, v in zip(names, values, strict=True))


def layers_section(layers: Sequence[Layer]) -> Markup:
    """Return discs of the transmission BSDF, and curves of the transmittance."""
    if not layers:
        return Markup("")
    shown = [layer.bsdf() for layer in layers[:_MOST]]
    sources = [
        direction_from_angles(*source, "transmission_front") for source in _SOURCES
    ]
    names = ", ".join(layer.name for layer in layers[:_MOST])
    discs = shown[:_MOST_DISCS]
    lobes = _image(
        lobe_figure(discs, sources),
        f"Light sent into the room by {names}, along the normal and from 45° above",
    )
    shares = _image(
        share_figure(shown), f"Share of light that passes {names}, by angle"
    )
    return render(
        "layers.html",
        count=len(layers),
        discs=_MOST_DISCS,
        shown=len(shown),
        lobes=lobes,
        shares=shares,
    )


def _image(drawing: Drawing, words: str) -> Markup:
    stream = io.BytesIO()
    drawing.savefig(stream, format="png", dpi=_DPI, metadata={"Software": None})
    width, height = (drawing.get_size_inches() * _DPI).round().astype(int).tolist()
    address = png_address(stream.getvalue())
    return element("img", src=address, alt=words, width=width, height=height)
