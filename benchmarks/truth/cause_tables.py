"""The section on causes behind the film: direct sun, the rest, finer patches."""

from collections.abc import Iterable

import numpy as np

from truth.film_causes import VARIANTS
from truth.kept import Arrays
from truth.setting import demo


def section(found: Arrays, causes: Arrays) -> list[str]:
    """Return the section; `causes` are those of `truth.film_causes`."""
    real, direct, dark = found["lux"], causes["lux_direct"], causes["lux_black"]
    rest = found["lux_sky"] + found["lux_reflected_sun"]
    three, five = found["lux_three"], found["lux_five"]
    sun = found["lux_direct_sun"]
    parts = {
        "direct sun": (direct, three - rest - direct, sun - direct),
        "the rest": (real - direct, *2 * [rest - (real - direct)]),
        "both": (real, three - real, five - real),
    }
    minutes = float(causes["seconds"]) / 60
    lines = [
        "",
        "## Causes behind the film",
        "",
        f"{_PARTS} {minutes:.0f} more minutes of processor time.",
        "",
        *_table(_HEADS),
    ]
    for plane, chosen in _planes():
        for name, (true, *both) in parts.items():
            cells = [f"{np.mean((true / real)[chosen]):.0%}"]
            cells += [_cell((apart / real)[chosen]) for apart in both]
            gain = [abs(apart / real)[chosen] for apart in both]
            cells.append(_change(gain[0] - gain[1]))
            lines.append(_row(f"{name}, {plane}", cells))
    lines += ["", *_FINER, *_table(_VARIED)]
    apart = {
        (variant.text, name): (made + direct - true) / real
        for variant, made in zip(VARIANTS, causes["lux_rest"], strict=True)
        for name, true in (("real", real), ("dark", dark))
    }
    for variant in VARIANTS:
        cells = [
            _cell(apart[variant.text, name][chosen])
            for name in ("real", "dark")
            for _, chosen in _planes()
        ]
        lines.append(_row(variant.text, cells))
    return [*lines, "", _finding(found, causes, apart)]


def _finding(
    found: Arrays, causes: Arrays, apart: dict[tuple[str, str], np.ndarray]
) -> str:
    real, dark = found["lux"], causes["lux_black"]
    noise = np.median(np.hypot(found["lux_error"], causes["lux_black_error"]) / real)
    by_rays = causes["flux_rays"]
    lit = by_rays > 0
    ratios = [f"{each:.2f}" for each in causes["flux_patches"][lit] / by_rays[lit]]
    dull = np.sum(~lit)
    none = f", but for {dull} in which no ray of the sun passes" if dull else ""
    sizes = []
    for plane, chosen in _planes():
        usual, rays = (apart[VARIANTS[n].text, "dark"][chosen] for n in (0, -2))
        sizes.append(
            f"{plane} {_change(usual - rays)} by the patches and"
            f" {_change((dark / real - 1)[chosen])} by the missing light"
        )
    return (
        "Most of the deviation is that of the rest, not of the direct sun. It has two"
        " errors of opposite sign, which five phases leave. (1) The sun is spread over"
        " patches of the sky and of the window, and its flux through the film is"
        f" {', '.join(ratios)} times that by rays, in the order of the hours{none}"
        " (furthest off in June, when little of it passes). Finer patches lessen this;"
        " once the rays enter in place of patches, finer patches inside change little."
        " (2)"
        " The film reflects light of the room back into it, which no view matrix"
        f" contains. Mean changes of illuminance: {'; '.join(sizes)}. What"
        " remains in the last rows includes noise: the two truths have a standard"
        f" error of {noise:.1%} together, the median of all values."
    )


def _planes() -> Iterable[tuple[str, np.ndarray]]:
    level = demo()[3]
    return ("horizontal", level), ("vertical", ~level)


def _cell(apart: np.ndarray) -> str:
    # Mean deviation, and the mean of signed ones with a standard error over the hours
    return f"{abs(apart).mean():.1%} ({_change(apart)})"


def _change(values: np.ndarray) -> str:
    of_hours = values.mean(axis=0)
    error = of_hours.std(ddof=1) / np.sqrt(len(of_hours))
    return f"{of_hours.mean():+.1%} ± {error:.1%}"


def _table(heads: list[str]) -> list[str]:
    return [_row("", heads), "|---|" + "---|" * len(heads)]


def _row(name: str, cells: Iterable[str]) -> str:
    return f"| {name} | {' | '.join(cells)} |"


_PARTS = (
    "*Direct sun* is sunlight that reaches a sensor from the window without"
    " reflection in the room; in the truth, it is the sum over rays of the sun's"
    " disc that leave the prisms. *The rest*, V T D S - V_d T D_d S_ds, is the same"
    " in both methods; its deviation is what the exact direct sun would leave. Mean"
    " deviations in % of the whole illuminance, in brackets the means of the signed"
    " ones, with standard errors over the hours."
)

_HEADS = ["share in the truth", "3-phase", "5-phase", "gain by five phases"]

_FINER = [
    "The rest made again, with 16 times the paths of V: sky patches, patches of the"
    " window (V, T and D alike), and sun through the film by the rays of the truth, in"
    " place of T D_d S_ds. Deviations of its sum with the direct sun of the truth: from"
    " the truth, and from path tracing in which the film reflects no light of the room,"
    " as in the methods.",
    "",
]

_VARIED = [
    "horizontal",
    "vertical",
    "horizontal, without reflected light of the room",
    "vertical, without reflected light of the room",
]
