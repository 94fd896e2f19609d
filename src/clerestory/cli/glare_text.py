"""Glare results as text in the format of evalglare."""

import math
from collections.abc import Mapping

import numpy as np

from clerestory.glare.dgp import dgp
from clerestory.glare.indices import REPORTED, Glare
from clerestory.glare.luminance_statistics import FieldLuminances, RegionStatistics
from clerestory.glare.source_table import GlareSources
from clerestory.glare.veiling import veiling_luminance

# Name of the quantity for each column heading of evalglare
_LONG = {q.column: q.name for q in REPORTED if q.column}
_SHORT = {
    column: _LONG[column] for column in ("dgp", "dgi", "ugr", "vcp", "cgi", "Lveil")
}

# Column headings of the `FieldLuminances`, and the heading that follows them
_FIELD = ("av_lum_pos", "av_lum_pos2", "med_lum", "med_lum_pos", "med_lum_pos2")
_AFTER_FIELD = "ugp2"
_TABLE = (
    "No pixels x-pos y-pos L_s Omega_s Posindx L_b L_t E_v Edir Max_Lum Sigma xdir ydir"
    " zdir Eglare Lveil_cie teta glare_zone r_contrast r_dgp"
)

# Attributes of `RegionStatistics`, and their names in evalglare
_REGION = {
    "solid_angle": "omega",
    "average": "av_lum",
    "median": "median_lum",
    "deviation": "std_lum",
    "percentile_75": "perc_75",
    "percentile_95": "perc_95",
    "least": "lum_min",
    "most": "lum_max",
    "illuminance": "Ev",
}


def short_lines(result: Glare) -> list[str]:
    """Return the line of indices of evalglare, and the line of their errors."""
    values = result.values()
    numbers = _six(*(values[name] for name in _SHORT.values()))
    return [f"{','.join(_SHORT)}: {' '.join(numbers)}", *_errors(result, _SHORT)]


def _errors(result: Glare, columns: Mapping[str, str]) -> list[str]:
    # Line of the standard errors; no line if they are unknown
    if not result.errors:
        return []
    names = [f"{column}_error" for column in columns]
    numbers = _six(*(result.errors[name] for name in columns.values()))
    return [f"{','.join(names)}: {' '.join(numbers)}"]


def long_lines(result: Glare, field: FieldLuminances) -> list[str]:
    """Return the line of indices of evalglare -d, and the line of their errors."""
    values = result.values()
    numbers = {column: values[name] for column, name in _LONG.items()}
    last = {_AFTER_FIELD: numbers.pop(_AFTER_FIELD)}
    numbers |= dict(zip(_FIELD, field, strict=True)) | last
    line = f"{','.join(numbers)}: {' '.join(_six(*numbers.values()))}"
    return [line, *_errors(result, _LONG)]


def source_lines(result: Glare) -> list[str]:
    """Return the table of glare sources that evalglare -d prints."""
    sources, veils = result.sources, veiling_luminance(result.sources)
    lines = [f"{sources.count} {_TABLE}"]
    common = (
        result.background,
        result.reference,
        result.illuminance,
        result.direct_illuminance,
        result.brightest,
    )
    contrast, share = _shares(result)
    for i in range(sources.count):
        sigma = math.degrees(sources.sigma[i])
        place = sources.pixels[i], sources.column[i], sources.row[i] + 1
        after = sources.position_index[i], *common, sigma, *sources.direction[i]
        words = [
            *_six(*place, sources.luminance[i]),
            f"{sources.solid_angle[i]:.10f}",
            *_six(*after, sources.illuminance[i], veils[i], sigma),
            f"{sources.zone[i]}",
            *_six(contrast[i], share[i]),
        ]
        lines.append(" ".join([str(i + 1), *words]))
    return lines


def _six(*numbers: float) -> list[str]:
    return [f"{number:.6f}" for number in numbers]


def _shares(result: Glare) -> tuple[np.ndarray, np.ndarray]:
    # Contrast term of DGP for each glare source alone, as a fraction of the contrast
    # term for all sources and as a fraction of DGP
    sources, k = result.sources, result.settings.coefficients
    scale = result.illuminance**k.a3
    each = k.c2 * np.log10(1 + sources.weight() / scale)
    total = k.c2 * math.log10(1 + float(sources.weight().sum()) / scale)
    whole = dgp(sources, illuminance=result.illuminance, coefficients=k)
    return each / total if total > 0 else each, each / whole


def source_rows(sources: GlareSources) -> list[dict[str, float]]:
    """Return one dictionary per glare source."""
    columns = {
        "pixels": sources.pixels,
        "row": sources.row,
        "column": sources.column,
        "luminance": sources.luminance,
        "luminance_error": sources.luminance_error,
        "solid_angle": sources.solid_angle,
        "position_index": sources.position_index,
        "sigma_deg": np.degrees(sources.sigma),
        "illuminance": sources.illuminance,
        "zone": sources.zone,
    }
    return [
        {name: column[i].item() for name, column in columns.items()}
        for i in range(sources.count)
    ]


def region_line(name: str, part: RegionStatistics) -> str:
    """Return luminance statistics of a band, mask or zone in evalglare's format."""
    names = ",".join(f"{name}_{word}" for word in (*_REGION.values(), "pixels"))
    numbers = _six(*(getattr(part, attribute) for attribute in _REGION))
    return f"{names}: {' '.join(numbers)} {part.pixels}"
