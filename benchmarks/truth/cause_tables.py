"""The page of causes: sun through the film, and DGP behind the microlouvre."""

from collections.abc import Sequence

from duel import stamp
from five_phase_truth import FEW

from truth.facades import Kind
from truth.kept import Arrays
from truth.setting import demo, pictured, weather


def page(
    found: dict[Kind, Arrays],
    suns: dict[Kind, Arrays],
    louvre: Arrays,
    cases: Sequence[tuple[int, int]],
    variants: Arrays,
) -> str:
    """Return the whole page."""
    seconds = sum(float(each["seconds"]) for each in (*suns.values(), variants))
    lines = [
        "# Why five phases deviate from path tracing",
        "",
        f"{stamp()}. Made by `benchmarks/five_phase_causes.py` in {seconds / 60:.0f}"
        " minutes of processor time, from the cases of [five phases against path"
        " tracing](five-phase.md).",
        "",
        *_REFLECTED_SUN,
        *(line for kind in found for line in _parts(kind, found[kind], suns[kind])),
        "",
        "## DGP behind the microlouvre",
        "",
        *_louvre(louvre, cases, variants),
    ]
    return "\n".join(lines) + "\n"


def _parts(kind: Kind, found: Arrays, sun: Arrays) -> list[str]:
    # Parts of five phases, and of the truth
    direct, sky = sun["lux_direct"][:, FEW], sun["lux_sky_traced"]
    reflected = found["lux"] - sky - direct
    ratio = (sun["exact"] / sun["spread"])[FEW]
    corrected = sky + direct + found["lux_reflected_sun"] * ratio
    level = demo()[3]
    lines = [
        "",
        f"### {kind.name[0].upper()}{kind.name[1:]}",
        "",
        "| hour, plane | sky | direct sun | reflected sun | sky, method / truth |"
        " direct sun, method / truth | reflected sun, method / truth | flux in patches"
        " / by rays | 5-phase / truth |",
        "|---|" + "---|" * 8,
    ]
    gains = []
    for plane, chosen in (("horizontal", level), ("vertical", ~level)):
        pairs = [
            (true[chosen].sum(axis=0), found[f"lux_{name}"][chosen].sum(axis=0))
            for name, true in (
                ("sky", sky),
                ("direct_sun", direct),
                ("reflected_sun", reflected),
            )
        ]
        whole, five = (found[part][chosen].sum(axis=0) for part in ("lux", "lux_five"))
        for step, hour in enumerate(FEW):
            shares = [f"{true[step] / whole[step]:.0%}" for true, _ in pairs]
            ratios = [
                _ratio(made[step], true[step], whole[step]) for true, made in pairs
            ]
            lines.append(
                f"| {weather().times[hour]}, {plane} | {' | '.join(shares)} |"
                f" {' | '.join(ratios)} | {1 / ratio[step]:.3f} |"
                f" {five[step] / whole[step]:.3f} |"
            )
        before, after = (
            abs(part[chosen] / found["lux"][chosen] - 1).mean()
            for part in (found["lux_five"], corrected)
        )
        gains.append(f"{plane} from {before:.1%} to {after:.1%}")
    lines += [
        "",
        "With the sky and the direct sun of the truth, and the reflected sun multiplied"
        f" by the ratio of the fluxes, mean deviations change: {', '.join(gains)}.",
    ]
    return lines


def _ratio(made: float, true: float, whole: float) -> str:
    # Nothing is said of parts below a hundredth
    return f"{made / true:.3f}" if true > 0.01 * whole else "–"


def _louvre(
    found: Arrays, cases: Sequence[tuple[int, int]], variants: Arrays
) -> list[str]:
    heads = [
        f"eye {eye + 1}, {pictured().times[step].astype(str)}" for eye, step in cases
    ]
    lines = [
        f"DGP of the {len(cases)} cases in which five phases deviate most. *Sky by"
        " path tracing*: the sun by five phases, added to a picture of the sky that is"
        " traced through the bars; *sun by path tracing*: the reverse.",
        "",
        f"| | {' | '.join(heads)} |",
        "|---|" + "---|" * len(heads),
    ]
    error = [found["glare_error"][0][case] for case in cases]
    lines.append(_row("standard error of the truth", error, "{:.4f}"))
    for name, values in variants.items():
        if name != "seconds":
            lines.append(_row(name, values, "{:.4f}"))
    return lines


def _row(name: str, values: Sequence[float], how: str) -> str:
    return f"| {name} | {' | '.join(how.format(value) for value in values)} |"


_REFLECTED_SUN = [
    "## Parts of five phases",
    "",
    "Five phases replace the sun that arrives at a sensor straight from the window, and"
    " in pictures also sun that is reflected once. Light of the sky, and sun that the"
    " room has reflected, remain those of V T D S: of Klems patches, and of the sun"
    " spread over four patches of the sky. The tables give the shares of the parts in"
    " the truth, summed over sensors, and what the method makes of them; then the flux"
    " of the sun through the window, in patches and by rays of its disc through the"
    " geometry. Direct sun of the truth is that of the same rays; reflected sun is the"
    " rest.",
]
