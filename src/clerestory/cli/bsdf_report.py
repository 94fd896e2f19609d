"""Text output of `clerestory bsdf`: descriptions, findings, differences."""

import json
from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path

import numpy as np

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.layer_comparison import Comparison
from clerestory.bsdf.other_readers import READERS
from clerestory.bsdf.quality_finding import Finding, explained_once, patch_label
from clerestory.bsdf.scattering_function import FUNCTIONS, Function
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.hemisphere.klems import klems


def function_title(channel: str, function: Function) -> str:
    """Return the title of a scattering function, such as "visible reflection back"."""
    return f"{channel} {function.replace('_', ' ')}"


def info_lines(bsdf: Bsdf) -> Iterator[str]:
    """Yield a description of a BSDF: product, bases, transmittances, reflectances."""
    product = bsdf.product
    yield f"{'name':22}{product.name or '-'}"
    yield f"{'manufacturer':22}{product.manufacturer or '-'}"
    yield f"{'device type':22}{product.device_type or '-'}"
    yield f"{'channels':22}{', '.join(bsdf.channels) or '-'}"
    for channel in bsdf.channels:
        for function in FUNCTIONS:
            if (channel, function) in bsdf.functions:
                title = function_title(channel, function)
                yield f"{title:34}{_summary(bsdf, channel, function)}"
    for note in bsdf.notes:
        yield f"{'note':22}{note}"


def finding_lines(
    file: Path, findings: Sequence[Finding], *, all_of_them: bool
) -> Iterator[str]:
    """Yield a line per finding (`all_of_them`) or per finding that affects results.

    The last line says which other programs read the file.
    """
    shown = [f for f in findings if f.matters or all_of_them]
    yield from (f"{file}: {line}" for line in explained_once(shown))
    refused = {f.where: f.what for f in findings if f.name == "reader"}
    readers = [reader for reader in READERS if reader not in refused]
    answers = [f"read by {' and '.join(readers)}"] if readers else []
    answers += [
        f"not {'' if readers else 'read '}by {who} ({why})"
        for who, why in refused.items()
    ]
    sound = "" if any(finding.matters for finding in findings) else "sound; "
    yield f"{file}: {sound}{'; '.join(answers)}"


def findings_json(reports: Sequence[tuple[Path, Sequence[Finding], str]]) -> str:
    """Return the findings or the reading error of each file as JSON."""
    rows = [
        {
            "file": str(file),
            "status": "unreadable" if error else _status(findings),
            "error": error or None,
            "findings": [asdict(finding) for finding in findings],
        }
        for file, findings, error in reports
    ]
    return json.dumps(rows, indent=1, ensure_ascii=False)


def comparison_lines(result: Comparison, names: tuple[str, str]) -> Iterator[str]:
    """Yield lines of text on the differences between two BSDFs."""
    first, second = result.diffuse
    yield f"{names[1]} against {names[0]}"
    yield f"  {'diffuse light':34}{first:.4f} and {second:.4f}"
    yield f"  {'BSDF, rms difference':34}{result.rms:.4g}/sr, mean {result.mean:.4g}/sr"
    yield f"  {'light that goes elsewhere':34}{result.redistributed:.2%}"
    yield (
        f"  {'share scattered in all':34}{result.share_bias:+.4f} on average,"
        f" {result.share_rms:.4f} rms, {result.share_worst:+.4f} at most, at"
        f" {patch_label(result.incidents, result.worst_patch)}"
    )
    if result.exchange is not None:
        title, rest = result.exchange
        yield f"  {title}: without this exchange, {rest:.2%} goes elsewhere"


def _status(findings: Sequence[Finding]) -> str:
    return "doubtful" if any(finding.matters for finding in findings) else "sound"


def _summary(bsdf: Bsdf, channel: str, function: Function) -> str:
    # Basis, and transmittance or reflectance for normal and for diffuse incidence
    part = bsdf.functions[channel, function]
    on = part if isinstance(part, ScatteringMatrix) else None
    table = on or bsdf.function(function, channel=channel, partition=klems("full"))
    kind = (
        f"{len(on.exits)} x {len(on.incidents)} ({on.exits.name})"
        if on
        else "tensor tree"
    )
    share = table.direct_hemispherical()
    weight = table.incidents.projected_solid_angles()
    normal = int(np.argmax(table.incidents.centres()[:, 2]))
    diffuse = float(share @ weight / weight.sum())
    return f"{kind}: {share[normal]:.3f} from the normal, {diffuse:.3f} diffuse"
