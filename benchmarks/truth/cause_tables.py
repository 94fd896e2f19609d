"""The page of causes: sun through the film, and DGP behind the microlouvre."""

from collections.abc import Sequence

import numpy as np
from duel import stamp

from truth.kept import Arrays
from truth.setting import demo, pictured, weather


def page(
    film: Arrays,
    flux: Arrays,
    louvre: Arrays,
    cases: Sequence[tuple[int, int]],
    variants: Arrays,
) -> str:
    """Return the whole page."""
    seconds = sum(float(found["seconds"]) for found in (flux, variants))
    lines = [
        "# Why five phases deviate from path tracing",
        "",
        f"{stamp()}. Made by `benchmarks/five_phase_causes.py` in {seconds / 60:.0f}"
        " minutes of processor time, from the cases of [five phases against path"
        " tracing](five-phase.md).",
        "",
        "## Behind the film",
        "",
        *_film(film, flux),
        "",
        "## DGP behind the microlouvre",
        "",
        *_louvre(louvre, cases, variants),
    ]
    return "\n".join(lines) + "\n"


def _film(found: Arrays, flux: Arrays) -> list[str]:
    level = demo()[3]
    real = found["lux"][level]
    ratio = flux["exact"] / flux["spread"]
    scaled = found["lux_five"] + found["lux_reflected_sun"] * (ratio - 1)
    off = {
        "three": found["lux_three"][level] / real - 1,
        "five": found["lux_five"][level] / real - 1,
        "scaled": scaled[level] / real - 1,
    }
    share = found["lux_reflected_sun"][level] / real
    lines = [
        "Five phases replace the sun that arrives at a sensor straight from the window."
        " Sun that the room has reflected remains that of V T D S: its flux through the"
        " window is the mean over a Klems patch and four patches of the sky. The table"
        " compares this flux with that of rays of the disc through the prisms, and the"
        " deviations of horizontal illuminance, before and after the reflected sun is"
        " multiplied by the ratio of both.",
        "",
        "| hour | flux in patches / by rays | share of reflected sun | 3-phase, bias |"
        " 5-phase, bias | with the flux by rays |",
        "|---|---|---|---|---|---|",
    ]
    for step, time in enumerate(weather().times.astype(str)):
        bias = [f"{each[:, step].mean():+.1%}" for each in off.values()]
        lines.append(
            f"| {time} | {1 / ratio[step]:.3f} | {share[:, step].mean():.0%} |"
            f" {' | '.join(bias)} |"
        )
    mean = [f"{abs(each).mean():.1%}" for each in off.values()]
    lines.append(f"| mean deviation | | {share.mean():.0%} | {' | '.join(mean)} |")
    among = np.corrcoef(1 / ratio, off["five"].mean(axis=0))[0, 1]
    lines += [
        "",
        "The correlation between the ratio of the fluxes and the bias of five phases is"
        f" {among:.2f} over the hours.",
    ]
    return lines


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
