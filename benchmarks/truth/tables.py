"""The page: shares of values that three and five phases find, and how sure they are."""

import numpy as np
from duel import stamp

from truth.setting import EDGE, Kind, demo, pictured, weather

LIMITS = (0.05, 0.10, 0.20)

_Arrays = dict[str, np.ndarray]


def page(results: dict[Kind, _Arrays], *, targets: tuple[float, float]) -> str:
    """Return the whole page.

    `targets`: relative standard error of illuminance, and standard error of DGP.
    """
    level = demo()[3]
    head = " | ".join(f"{m} < {x:.0%}" for m in ("3-phase", "5-phase") for x in LIMITS)
    lines = [
        "# Three and five phases against path tracing",
        "",
        f"{stamp()}. {len(weather().times)} sunny hours,"
        f" {int(level.sum())} horizontal and {int((~level).sum())} vertical sensors;"
        f" DGP of {int((~level).sum())} eyes in {len(pictured().times)} of these hours,"
        f" from pictures of {EDGE} × {EDGE} pixels. The reference is traced until the"
        f" standard error of each illuminance is {targets[0]:.0%}, and that of each DGP"
        f" {targets[1]:g}. Made by `benchmarks/five_phase_truth.py`.",
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
        " relative standard error of illuminance (root mean square), standard error of"
        " DGP, and the change of DGP by the noise of pixels; then the root mean square"
        " deviations of DGP by the methods; and the processor time of the reference,"
        " of all illuminances and of all pictures [s].",
        "",
        "| | horizontal | vertical | DGP | noise adds | truth's DGP"
        " | 3-phase | 5-phase | seconds |",
        "|---|" + "---|" * 8,
        *noise,
    ]
    return "\n".join(lines) + "\n"


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
    flat, upright = (np.sqrt(np.mean(error[c] ** 2)) for c in (level, ~level))
    real = found["dgp-all"]
    first, second = found["dgp-halves"]
    sure = np.sqrt(np.mean((first - second) ** 2)) / 2
    far = [
        np.sqrt(np.mean((found[f"dgp-{method}"] - real) ** 2))
        for method in ("three", "five")
    ]
    cells = [
        f"{flat:.1%}",
        f"{upright:.1%}",
        f"{sure:.4f}",
        f"{np.mean(first + second) / 2 - np.mean(real):+.4f}",
        f"{real.min():.2f} to {real.max():.2f}",
        *(f"{each:.3f}" for each in far),
        f"{found['lux-seconds']:.0f} + {found['dgp-seconds']:.0f}",
    ]
    return f"| {kind.name} | {' | '.join(cells)} |"
