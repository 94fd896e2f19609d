"""The page: shares of values that three and five phases find, and how sure they are."""

import numpy as np
from duel import stamp

from truth.check import SUN_DEG
from truth.setting import EDGE, Kind, demo, pictured, weather

LIMITS = (0.05, 0.10, 0.20)

_Arrays = dict[str, np.ndarray]


def page(
    results: dict[Kind, _Arrays],
    proof: _Arrays,
    *,
    paths: tuple[int, int],
    film: int,
) -> str:
    """Return the whole page.

    Parameters
    ----------
    proof : of the film's truth; empty where there is none
    paths : of the truth, of a sensor and of a pixel
    film : times as many behind the film
    """
    level = demo()[3]
    head = " | ".join(f"{m} < {x:.0%}" for m in ("3-phase", "5-phase") for x in LIMITS)
    lines = [
        "# Three and five phases against path tracing",
        "",
        f"{stamp()}. {len(weather().times)} sunny hours,"
        f" {int(level.sum())} horizontal and {int((~level).sum())} vertical sensors;"
        f" DGP of {int((~level).sum())} eyes in {len(pictured().times)} of these hours,"
        f" from pictures of {EDGE} × {EDGE} pixels. The reference takes {paths[0]:,}"
        f" paths a sensor and hour and {paths[1]:,} a pixel and hour, behind the film"
        f" {film} times as many. Made by `benchmarks/five_phase_truth.py`.",
        "",
        f"| share of values that differ by | {head} |",
        "|---|" + "---|" * 6,
    ]
    noise = []
    for kind, found in results.items():
        lux = [found[f"lux-{part}"] for part in ("all", "three", "five")]
        for plane, chosen in (("horizontal", level), ("vertical", ~level)):
            lines.append(_row(f"{kind.name}, {plane}", *(v[chosen] for v in lux)))
        glare = [found[f"dgp-{part}"] for part in ("all", "three", "five")]
        lines.append(_row(f"{kind.name}, DGP", *glare))
        noise.append(_noise(kind, found, level))
    lines += [
        "",
        "Uncertainty of the reference, from the difference of two halves of its paths:"
        " relative standard error of illuminance, standard error of DGP, and the change"
        " of DGP by the noise of pixels; then the root mean square deviations of DGP by"
        " the methods.",
        "",
        "| | horizontal, median | vertical, median | DGP | noise adds | truth's DGP"
        " | 3-phase | 5-phase |",
        "|---|" + "---|" * 7,
        *noise,
        *_NOTES,
    ]
    return "\n".join([*lines, *_proof(proof)]) + "\n"


def _row(name: str, real: np.ndarray, *found: np.ndarray) -> str:
    cells = []
    for values in found:
        apart = abs(values / real - 1)
        cells += [f"{np.mean(apart < limit):.0%}" for limit in LIMITS]
    return f"| {name} | {' | '.join(cells)} |"


def _noise(kind: Kind, found: _Arrays, level: np.ndarray) -> str:
    # Half the difference of two halves is the error of their mean
    one, other = found["lux-halves"]
    error = abs(one - other) / 2 / found["lux-all"]
    flat, upright = (np.sqrt(np.mean(error[c] ** 2, axis=1)) for c in (level, ~level))
    real = found["dgp-all"]
    first, second = found["dgp-halves"]
    sure = np.sqrt(np.mean((first - second) ** 2)) / 2
    far = [
        np.sqrt(np.mean((found[f"dgp-{method}"] - real) ** 2))
        for method in ("three", "five")
    ]
    cells = [
        f"{np.median(flat):.1%}",
        f"{np.median(upright):.1%}",
        f"{sure:.4f}",
        f"{np.mean(first + second) / 2 - np.mean(real):+.4f}",
        f"{real.min():.2f} to {real.max():.2f}",
        *(f"{each:.3f}" for each in far),
    ]
    return f"| {kind.name} | {' | '.join(cells)} |"


def _proof(proof: _Arrays) -> list[str]:
    if not proof:
        return []
    ours, blind, error = (proof[part] for part in ("ours", "blind", "error"))
    ratio = ours.sum() / blind.sum() - 1
    apart = np.median(abs(ours / blind - 1))
    return [
        "",
        "The reference behind the film was checked by plain path tracing of the same"
        f" prisms under a sun of {SUN_DEG:g}° of equal irradiance, which"
        f" paths hit by chance. In {len(ours)} hours the sum over all sensors differs"
        f" by {ratio:+.1%}, with a standard error of"
        f" {np.sqrt((error**2).sum()) / blind.sum():.1%}; the median sensor by"
        f" {apart:.1%}, with a standard error of {np.median(error / blind):.1%}.",
    ]


_NOTES = [
    "",
    "The noise of the reference increases the deviations of both methods equally.",
]
