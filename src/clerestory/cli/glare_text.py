"""Text of a glare evaluation in the format of evalglare."""

import math

import numpy as np

from clerestory.glare.dgp import dgp
from clerestory.glare.field_luminance import FieldLuminances
from clerestory.glare.indices import REPORTED
from clerestory.glare.region_statistics import RegionStatistics
from clerestory.glare.result import Glare
from clerestory.glare.source_table import GlareSources
from clerestory.glare.veiling import veiling_luminance

# Name of the quantity in each column of evalglare
_SHORT = {q.column: q.name for q in REPORTED if q.column and q.in_short_line}
_LONG = {q.column: q.name for q in REPORTED if q.column}

# Columns of `FieldLuminances`, and the column after these
_FIELD = ("av_lum_pos", "av_lum_pos2", "med_lum", "med_lum_pos", "med_lum_pos2")
_AFTER_FIELD = "ugp2"
_TABLE = (
    "No pixels x-pos y-pos L_s Omega_s Posindx L_b L_t E_v Edir Max_Lum Sigma xdir ydir"
    " zdir Eglare Lveil_cie teta glare_zone r_contrast r_dgp"
)


def short_line(result: Glare) -> str:
    """Return the line that evalglare prints without options."""
    values = result.values()
    numbers = " ".join(f"{values[name]:.6f}" for name in _SHORT.values())
    return f"{','.join(_SHORT)}: {numbers}"


def long_line(result: Glare, field: FieldLuminances) -> str:
    """Return the line of all indices that evalglare -d prints."""
    values = result.values()
    numbers = {column: values[name] for column, name in _LONG.items()}
    last = {_AFTER_FIELD: numbers.pop(_AFTER_FIELD)}
    numbers |= dict(zip(_FIELD, field, strict=True)) | last
    return f"{','.join(numbers)}: {' '.join(f'{x:.6f}' for x in numbers.values())}"


def source_lines(result: Glare) -> list[str]:
    """Return the table of sources that evalglare -d prints."""
    sources = result.sources
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
        numbers = [
            float(sources.pixels[i]),
            sources.column[i],
            sources.row[i] + 1,
            sources.luminance[i],
        ]
        words = [f"{number:.6f}" for number in numbers]
        words.append(f"{sources.solid_angle[i]:.10f}")
        veil = veiling_luminance(sources)[i]
        rest = [sources.position_index[i], *common, sigma, *sources.direction[i]]
        rest += [sources.illuminance[i], veil, sigma]
        words += [f"{number:.6f}" for number in rest]
        words += [f"{sources.zone[i]}", f"{contrast[i]:.6f}", f"{share[i]:.6f}"]
        lines.append(" ".join([str(i + 1), *words]))
    return lines


def _shares(result: Glare) -> tuple[np.ndarray, np.ndarray]:
    # Contribution of each source to the contrast term of DGP, relative to the whole
    # contrast term and relative to DGP
    sources, k = result.sources, result.coefficients
    scale = result.illuminance**k.a3
    each = k.c2 * np.log10(1 + sources.weight() / scale)
    total = k.c2 * math.log10(1 + float(sources.weight().sum()) / scale)
    whole = dgp(sources, illuminance=result.illuminance, coefficients=k)
    return each / total if total > 0 else each, each / whole


def source_rows(sources: GlareSources) -> list[dict[str, float]]:
    """Return the glare sources as records."""
    return [
        {
            "pixels": int(sources.pixels[i]),
            "row": float(sources.row[i]),
            "column": float(sources.column[i]),
            "luminance": float(sources.luminance[i]),
            "solid_angle": float(sources.solid_angle[i]),
            "position_index": float(sources.position_index[i]),
            "sigma_deg": math.degrees(sources.sigma[i]),
            "illuminance": float(sources.illuminance[i]),
            "zone": int(sources.zone[i]),
        }
        for i in range(sources.count)
    ]


def region_line(name: str, part: RegionStatistics) -> str:
    """Return the statistics of a band, mask or zone in the format of evalglare."""
    words = (
        "omega",
        "av_lum",
        "median_lum",
        "std_lum",
        "perc_75",
        "perc_95",
        "lum_min",
        "lum_max",
        "Ev",
        "pixels",
    )
    numbers = (
        part.solid_angle,
        part.average,
        part.median,
        part.deviation,
        part.percentile_75,
        part.percentile_95,
        part.least,
        part.most,
        part.illuminance,
    )
    names = ",".join(f"{name}_{word}" for word in words)
    return f"{names}: {' '.join(f'{x:.6f}' for x in numbers)} {part.pixels}"
