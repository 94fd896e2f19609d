"""Figures of window layers: discs of the BSDF, and curves of the transmittance."""

import xarray as xr
from matplotlib.figure import Figure

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems
from clerestory.report.bsdf_plot import direction_from_angles, lobe_figure, share_figure
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import figure_png, image_address
from clerestory.report.markup import Markup, element, render
from clerestory.report.section import Section

# Maximum numbers of layers drawn as discs and as curves; polar angle and azimuth of
# the source [°]; dots per inch
_MOST_DISCS, _MOST = 5, 8
_SOURCES = ((0.0, 90.0), (45.0, 90.0))
_DPI = 80


def window_layers(data: xr.Dataset) -> list[Bsdf]:
    """Return the BSDFs of the window layers in the results, in the full Klems basis."""
    if "layer_transmission" not in data:
        return []
    patches = klems("full")
    layers = zip(data["layer"].values, data["layer_transmission"].values, strict=True)
    return [
        Bsdf(
            {("visible", "transmission_front"): ScatteringMatrix(v, patches, patches)},
            Product(name=str(name)),
        )
        for name, v in layers
    ]


def layers_section(content: ReportContent) -> Section:
    """Return the section with BSDF discs and transmittance curves of window layers."""
    layers = window_layers(content.data)
    if not layers:
        return Section()
    shown = layers[:_MOST]
    sources = [direction_from_angles(*s, "transmission_front") for s in _SOURCES]
    names = ", ".join(layer.product.name for layer in shown)
    lobes = f"BSDF of {names}, for light along the normal and from 45° above"
    shares = f"Transmittance of {names}, by angle of incidence"
    return Section(
        render(
            "layers.html",
            count=len(layers),
            discs=_MOST_DISCS,
            shown=len(shown),
            lobes=_image(lobe_figure(shown[:_MOST_DISCS], sources), lobes),
            shares=_image(share_figure(shown), shares),
        )
    )


def _image(drawing: Figure, words: str) -> Markup:
    width, height = (drawing.get_size_inches() * _DPI).round().astype(int).tolist()
    address = image_address(figure_png(drawing, dpi=_DPI))
    return element("img", src=address, alt=words, width=width, height=height)
