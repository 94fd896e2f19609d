"""Interactive view of a BSDF as one self-contained HTML file.

A matrix is shown on its own patches. A tensor tree, or a matrix of more than a million
values, is averaged over the 145 incident patches of the full Klems basis and over exit
patches about three degrees wide; flux is conserved.
"""

from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float, UInt16

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.quality_checks import check
from clerestory.bsdf.quality_finding import explained_once
from clerestory.bsdf.scattering_function import Function
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.checks import require
from clerestory.files import write_text
from clerestory.hemisphere.klems import from_rings, klems
from clerestory.hemisphere.partition import RingPartition
from clerestory.report.colour import logarithmic_scale
from clerestory.report.embedded_data import packed
from clerestory.report.markup import render
from clerestory.report.page_assets import asset, render_page

_FUNCTIONS: tuple[Function, ...] = (
    "transmission_front",
    "reflection_front",
    "transmission_back",
    "reflection_back",
)
_SCRIPTS = ("raster.js", "solids.js", "bsdf_discs.js", "bsdf_lobes.js", "bsdf_view.js")

# Width of the exit patches over which a tensor tree is averaged [°].
_CELL_DEG = 3.0

# Decades shown below the maximum BSDF; number of 16-bit codes for them.
_DECADES = 6
_CODES = 65_534

# Maximum number of BSDF values on a page: about 8 MB after compression.
_MOST_VALUES = 5_000_000

# Number of BSDF values above which a matrix is averaged like a tensor tree.
_MOST_VALUES_OF_ONE = 1_000_000


def write_view(bsdf: Bsdf, path: str | Path) -> None:
    """Write the interactive view of a BSDF as one self-contained HTML file."""
    write_text(path, view_page(bsdf))


def view_page(bsdf: Bsdf) -> str:
    """Return the interactive view of a BSDF as HTML."""
    require(
        bsdf.functions,
        "the BSDF has no transmittance or reflectance; at least one expected",
        file=bsdf.source,
    )
    name = bsdf.product.name.strip()
    file = Path(bsdf.source).name if bsdf.source else ""
    title = file if name in ("", "Name") else name
    data, findings = view_data(bsdf), check(bsdf)
    body = render(
        "bsdf_view.html",
        title=title or "BSDF",
        subtitle=_subtitle(bsdf, file),
        left_out=data["left_out"],
        most=f"{_MOST_VALUES / 1e6:g}",
        findings=list(explained_once(f for f in findings if f.matters)),
        remarks=list(explained_once(f for f in findings if not f.matters)),
    )
    return render_page(
        title=f"{title or 'BSDF'} · scattering",
        style=asset("style.css") + asset("bsdf_view.css"),
        body=body,
        data=data,
        scripts=_SCRIPTS,
    )


def view_data(bsdf: Bsdf) -> dict[str, Any]:
    """Return the BSDF values, patches and colours of the view as JSON values.

    BSDF functions that would make the page too large are listed by name only.
    """
    functions: list[dict[str, Any]] = []
    left_out: list[str] = []
    room, coarse = _MOST_VALUES, (fine_partition(), klems("full"))
    for channel in sorted(bsdf.channels, key=lambda name: name != "visible"):
        for name in _FUNCTIONS:
            if not bsdf.has(name, channel=channel):
                continue
            part = bsdf.scattering(name, channel=channel)
            # Use the patches of the BSDF file, unless it has none or too many
            exits, incidents = part.own_partitions() or coarse
            if len(exits) * len(incidents) > _MOST_VALUES_OF_ONE:
                exits, incidents = coarse
            if len(exits) * len(incidents) > room:
                left_out.append(f"{channel} {name.replace('_', ' ')}")
                continue
            room -= len(exits) * len(incidents)
            shown = ScatteringMatrix(part.average(exits, incidents), exits, incidents)
            functions.append(_function_data(shown, channel, name))
    return {
        "functions": functions,
        "left_out": left_out,
        "colours": logarithmic_scale(1e-4, 1, "1/sr").table().tolist(),
    }


def fine_partition() -> RingPartition:
    """Return patches about three degrees wide, over which tensor trees are averaged."""
    limits = np.concatenate([[0.0], np.arange(_CELL_DEG / 2, 90, _CELL_DEG), [90.0]])
    middle = np.radians((limits[1:] + limits[:-1]) / 2)
    count = np.maximum(1, np.round(360 / _CELL_DEG * np.sin(middle) / 4) * 4)
    count[0] = 1
    return from_rings("View", limits_deg=limits, count=count.astype(int))


def _function_data(
    part: ScatteringMatrix, channel: str, name: Function
) -> dict[str, Any]:
    share = part.direct_hemispherical()
    weight = part.incidents.projected_solid_angles()
    high = float(part.values.max()) or 1.0
    return {
        "channel": channel,
        "name": name,
        "exits": _partition_data(part.exits),
        "incidents": _partition_data(part.incidents),
        "high": high,
        "step": _DECADES * float(np.log(10)) / _CODES,
        "codes": packed(value_codes(part.values.T, high)),
        "share": share.round(5).tolist(),
        "diffuse": round(float(share @ weight / weight.sum()), 5),
    }


def value_codes(
    values: Float[np.ndarray, "*batch"], high: float
) -> UInt16[np.ndarray, "*batch"]:
    """Encode values logarithmically in 16 bits; 0 if six decades or more below `high`.

    The relative error of decoded values is at most 0.01 %.
    """
    floor = high * 10.0**-_DECADES
    step = _DECADES * np.log(10) / _CODES
    codes = 1 + np.round(np.log(np.maximum(values, floor) / floor) / step)
    return np.where(values > floor, codes, 0).astype(np.uint16)


def _partition_data(partition: RingPartition) -> dict[str, Any]:
    return {
        "name": partition.name,
        "theta": partition.theta.round(7).tolist(),
        "count": partition.count.tolist(),
    }


def _subtitle(bsdf: Bsdf, file: str) -> str:
    part = next(iter(bsdf.functions.values()))
    kind = (
        f"matrix on {part.exits.name}"
        if isinstance(part, ScatteringMatrix)
        else f"tensor tree, shown on cells of {_CELL_DEG:g}°"
    )
    return " · ".join(word for word in (file, bsdf.product.manufacturer, kind) if word)
