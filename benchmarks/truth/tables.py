"""The page: shares of values that three and five phases find, and how sure they are."""

from collections.abc import Iterable, Sequence

import numpy as np
from duel import stamp

from truth.check import STEPS
from truth.facades import Kind
from truth.kept import Arrays
from truth.setting import EDGE, demo, pictured, weather

LIMITS = (0.05, 0.10, 0.20)
METHODS = ("three", "five")

# Standard errors of the truth that the page aims at: of DGP, and of illuminance
SURE_DGP, SURE_LUX = 0.005, 0.01


def page(
    results: dict[Kind, Arrays], hours: Sequence[int], proofs: dict[int, Arrays]
) -> str:
    """Return the page; `proofs` are the film's truth by a second route, by pitch."""
    level = demo()[3]
    seconds = sum(float(found["seconds"]) for found in results.values())
    lines = [
        "# Three and five phases against path tracing",
        "",
        f"{stamp()}. {len(hours)} sunny hours,"
        f" {int(level.sum())} horizontal and {int((~level).sum())} vertical sensors;"
        f" DGP of {int((~level).sum())} eyes in {len(pictured().times)} hours,"
        f" from pictures of {EDGE} × {EDGE} pixels. Made by"
        f" `benchmarks/five_phase_truth.py` in {seconds / 60:.0f} minutes of processor"
        " time.",
        "",
        *_INTRODUCTION,
        *_table("share of values that differ by", [*_heads(LIMITS)]),
    ]
    noise, nearer = [], []
    for kind, found in results.items():
        for name, real, _, both in quantities(found, level):
            cells = [cell for values in both for cell in shares(values, real)]
            lines.append(_row(f"{kind.name}, {name}", cells))
            share = "–" if name == "DGP" else _direct(found, level, name)
            nearer.append(_nearer(f"{kind.name}, {name}", real, both, share))
        noise.append(_noise(kind, found, level))
    lines += ["", *_UNCERTAINTY, *_table("", _SURE), *noise]
    lines += ["", *_AHEAD, *_table("", _COMPARED), *nearer]
    return "\n".join([*lines, *_proof(results, hours, proofs)]) + "\n"


def quantities(
    found: Arrays, level: np.ndarray
) -> Iterable[tuple[str, np.ndarray, np.ndarray, list[np.ndarray]]]:
    """Yield name, truth, its standard error, and the values of both methods."""
    for name, chosen in (("horizontal", level), ("vertical", ~level)):
        both = [found[f"lux_{method}"][chosen] for method in METHODS]
        yield name, found["lux"][chosen], found["lux_error"][chosen], both
    both = [found[f"glare_{method}"][0] for method in METHODS]
    yield "DGP", found["glare"][0], found["glare_error"][0], both


def shares(values: np.ndarray, real: np.ndarray) -> list[str]:
    """Return the shares of values within each limit, relative to the truth."""
    apart = abs(values / real - 1)
    return [f"{np.mean(apart < limit):.0%}" for limit in LIMITS]


def _heads(limits: Iterable[float]) -> list[str]:
    return [f"{m}-phase < {x:.0%}" for m in ("3", "5") for x in limits]


def _table(first: str, heads: list[str]) -> list[str]:
    return [_row(first, heads), "|---|" + "---|" * len(heads)]


def _row(name: str, cells: Iterable[str]) -> str:
    return f"| {name} | {' | '.join(cells)} |"


def _noise(kind: Kind, found: Arrays, level: np.ndarray) -> str:
    cells = []
    for name, real, error, both in quantities(found, level):
        if name == "DGP":
            rms = np.sqrt(np.mean(error**2))
            cells += [
                f"{rms:.4f}",
                f"{error.max():.4f}",
                f"{np.mean(error <= SURE_DGP):.0%}",
                f"{real.min():.2f} to {real.max():.2f}",
                *(f"{np.sqrt(np.mean((v - real) ** 2)):.4f}" for v in both),
            ]
        else:
            cells.append(f"{np.median(error / real):.2%}")
    return _row(kind.name, [*cells, f"{float(found['seconds']):.0f}"])


def _direct(found: Arrays, level: np.ndarray, plane: str) -> str:
    # Share of the only part that five phases replace
    chosen = level if plane == "horizontal" else ~level
    sun, whole = (found[part][chosen] for part in ("lux_direct_sun", "lux_five"))
    return f"{np.mean(sun / whole):.0%}"


def _nearer(name: str, real: np.ndarray, both: list[np.ndarray], share: str) -> str:
    three, five = (abs(values / real - 1) for values in both)
    gain = three - five
    # Steps under one sun are alike: hours are taken as the independent units
    of_hours = gain.mean(axis=0)
    error = of_hours.std(ddof=1) / np.sqrt(len(of_hours))
    cells = [
        f"{three.mean():.1%}",
        f"{five.mean():.1%}",
        f"{gain.mean():+.1%} ± {error:.1%}",
        f"{np.mean(gain > 0):.0%}",
        f"{np.mean(both[0] / real - 1):+.1%}",
        f"{np.mean(both[1] / real - 1):+.1%}",
        share,
    ]
    return _row(name, cells)


def _proof(
    results: dict[Kind, Arrays], hours: Sequence[int], proofs: dict[int, Arrays]
) -> list[str]:
    if not proofs:
        return []
    [found] = [found for kind, found in results.items() if kind.clear]
    steps = [list(hours).index(step) for step in STEPS]
    ours, error = (found[part][:, steps] for part in ("lux", "lux_error"))
    lines = ["", *_CHECK, *_table("pitch of the prisms", _CHECKED)]
    for pitch, proof in proofs.items():
        other = proof["lux"]
        joint = np.hypot(error, proof["lux_error"])
        z = (other - ours) / joint
        sums = [
            f"{part.sum() / mine.sum() - 1:+.1%} ± {np.linalg.norm(e) / mine.sum():.1%}"
            for part, mine, e in zip(other.T, ours.T, joint.T, strict=True)
        ]
        lines.append(_row(f"{pitch} mm", [*sums, f"{np.sqrt(np.mean(z**2)):.2f}"]))
    return [*lines, "", *_DEFECT]


_CHECK = [
    "Check of the truth behind the film: the path tracer of the package, whose cones"
    " of sunlight learn the way through prisms ([table](sun-patches.md)), against the"
    " truth above (prisms of 2 mm): sums over all sensors, and the root mean square"
    " deviation of a sensor in joint standard errors.",
    "",
]

_CHECKED = [*(str(weather().times[step]) for step in STEPS), "a sensor"]

_DEFECT = [
    "Prisms of both sizes deflect light alike. Few paths of the path tracer carry much"
    " of the light of a sensor, so its standard errors vary by chance.",
]

_SURE = [
    "horizontal",
    "vertical",
    "DGP, root mean square",
    "DGP, largest",
    f"DGP within {SURE_DGP}",
    "truth's DGP",
    "3-phase",
    "5-phase",
    "seconds",
]

_COMPARED = [
    "3-phase, mean deviation",
    "5-phase, mean deviation",
    "gain by five phases",
    "values nearer by five phases",
    "3-phase, bias",
    "5-phase, bias",
    "direct sun by five phases",
]

_INTRODUCTION = [
    "The slats of the blinds are 8 cm wide and 7.2 cm apart, matt (reflectance 0.48) or"
    " polished (0.8). The double façade has two panes 14 cm apart, with slats of 5 cm"
    " tilted by 30° between them. The prisms of the film are 2 mm high. The BSDFs are"
    " those of endless layers.",
    "",
]

_UNCERTAINTY = [
    "Standard error of the truth: of illuminance the median of all sensors and hours,"
    " relative; of DGP the root mean square and the largest of all eyes and hours. Then"
    " the root mean square deviations of DGP by the methods, and processor seconds.",
    "",
]

_AHEAD = [
    "Are five phases ahead? Mean relative deviations from the truth, and how much less"
    " those of five phases are, with a standard error over the hours; then the means of"
    " the signed deviations, and the mean share of sun straight from the window, the"
    " only part of illuminance that five phases replace.",
    "",
]
