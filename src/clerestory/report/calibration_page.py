"""HTML page on a calibration: values before and after, and on days not used."""

from pathlib import Path

import numpy as np

import clerestory
from clerestory.comparison.calibration_run import CalibratedStudy
from clerestory.comparison.series import ILLUMINANCE
from clerestory.comparison.series_comparison import Comparison, Rules
from clerestory.files import write_text
from clerestory.metrics.agreement import Agreement
from clerestory.report.comparison_plots import scatter_figure
from clerestory.report.embedded_data import figure_png, image_address
from clerestory.report.markup import Markup, drawing, element, render
from clerestory.report.page_assets import asset, content_policy
from clerestory.report.uncertain_value import number

PAGE_FILE = "calibration.html"

_WIDTH, _HEIGHT, _LEFT, _TOP = 260.0, 120.0, 10.0, 8.0
_HIGHEST = 6.0


def write_calibration_page(path: Path, found: CalibratedStudy, *, title: str) -> None:
    """Write the page on a calibration as one self-contained HTML file."""
    write_text(path, calibration_page(found, title=title))


def calibration_page(found: CalibratedStudy, *, title: str) -> str:
    """Return the page on a calibration, as HTML."""
    before, after = found.agreements()
    fit = found.calibration
    names = [unknown.name for unknown in fit.unknowns]
    return render(
        "calibration.html",
        version=clerestory.__version__,
        policy=content_policy(""),
        title=title,
        style=Markup(asset("style.css")),
        lead=_lead(found, before, after),
        agreements=_rows(found, before, after),
        quantities=_quantities(found),
        words=_words(found),
        names=names,
        correlations=[
            (name, [f"{value:+.2f}" for value in row])
            for name, row in zip(names, fit.correlations.tolist(), strict=True)
        ],
        profiles=[
            (name, _profile(*own, deviation=float(fit.deviations[k])))
            for k, (name, own) in enumerate(zip(names, found.profiles, strict=True))
        ],
        scatter=_scatter(found),
        error=f"{100 * fit.relative_error:.0f} %",
        sensor=f"{100 * fit.sensor_error:.0f} %",
        effect=f"{fit.design_effect:.1f}",
    )


def _lead(found: CalibratedStudy, before: Agreement, after: Agreement) -> str:
    words = (
        f"With the fitted values the mean deviation from {before.count:,} measured"
        f" values changes from {_signed(before.relative_bias)} to"
        f" {_signed(after.relative_bias)}, and the scatter, CV(RMSE), from"
        f" {100 * before.variation:.0f} % to {100 * after.variation:.0f} %."
    )
    if not found.held_out:
        return words + " All values are of one day: no day is left to test the result."
    better = sum(one.after.variation < one.before.variation for one in found.held_out)
    count = sum(one.count for one in found.held_out)
    within = sum(one.count * one.within for one in found.held_out) / count
    return words + (
        " On days that were not used for the fit, the scatter is smaller on"
        f" {better} of {len(found.held_out)}, and {100 * within:.0f} % of the values"
        " are within the 95 % range of their predictions."
    )


def _signed(share: float) -> str:
    return f"{100 * share:+.1f} %".replace("-", "−")


def _rows(
    found: CalibratedStudy, before: Agreement, after: Agreement
) -> list[tuple[str, list[str]]]:
    rows = [("all days, used for the fit", _cells(before, after))]
    rows += [
        (f"{one.day}, not used", _cells(one.before, one.after))
        for one in found.held_out
    ]
    return rows


def _cells(before: Agreement, after: Agreement) -> list[str]:
    pairs = [f"{before.count:,}"]
    for one in (before, after):
        pairs += [_signed(one.relative_bias), f"{100 * one.variation:.0f} %"]
    return pairs


def _quantities(found: CalibratedStudy) -> list[tuple[str, list[str]]]:
    # Value in the study, prior, posterior, and what the data told
    fit, rows = found.calibration, []
    for k, unknown in enumerate(fit.unknowns):
        prior, unit = unknown.distribution, f" {unknown.unit}".rstrip()
        spread = float(fit.deviations[k])
        kept = 1 - min(spread / prior.standard_deviation, 1.0) ** 2
        rows.append(
            (
                unknown.name,
                [
                    f"{number(found.quantities.reference[unknown.name])}{unit}",
                    f"{number(prior.mean)} ± {prior.standard_deviation:.2g}{unit}",
                    f"{number(float(fit.values[k]))} ± {spread:.2g}{unit}",
                    f"{100 * kept:.0f} %",
                ],
            )
        )
    return rows


def _words(found: CalibratedStudy) -> list[str]:
    # What the data cannot tell
    fit = found.calibration
    lines = []
    for one, other, correlation in fit.alike():
        acts = "the sum" if correlation < 0 else "the difference"
        lines.append(
            f"The measurements hardly tell {one} and {other} apart (correlation"
            f" {correlation:+.2f}): they fix {acts} of their effects, not each of them."
            " A measurement of one of them would help."
        )
    if fit.untold():
        lines.append(
            f"About {', '.join(fit.untold())} the measurements tell little: the values"
            " are mostly those that were assumed."
        )
    if fit.at_bounds():
        lines.append(
            f"{', '.join(fit.at_bounds())}: the value is at an end of its range. The"
            " range is too narrow, or another error of the model or of the"
            " measurements has the same effect."
        )
    if not lines:
        lines.append("The measurements tell all quantities apart.")
    if np.isfinite(fit.condition):
        lines.append(
            f"The best-known combination of quantities is known {fit.condition:,.0f}"
            " times as well by the data as the least-known one (condition number)."
        )
    return lines


def _profile(places: np.ndarray, loss: np.ndarray, *, deviation: float) -> Markup:
    # Loss over the values of one quantity, and the limit of one standard deviation
    low, high = float(places[0]), float(places[-1])
    span = max(high - low, 1e-12)
    xs = _LEFT + (places - low) / span * (_WIDTH - 2 * _LEFT)
    ys = _TOP + _HEIGHT * (1 - np.clip(loss, 0, _HIGHEST) / _HIGHEST)
    line = "M" + "L".join(f"{x:.1f} {y:.1f}" for x, y in zip(xs, ys, strict=True))
    one = _TOP + _HEIGHT * (1 - 1 / _HIGHEST)
    label = (
        f"Loss from {number(low)} to {number(high)}; standard deviation {deviation:.2g}"
    )
    return drawing(
        label,
        element("path", d=f"M{_LEFT} {one:.1f}H{_WIDTH - _LEFT}", stroke="#d9772b"),
        element(
            "path", d=f"M{_LEFT} {_TOP + _HEIGHT}H{_WIDTH - _LEFT}", stroke="#8a939d"
        ),
        element("path", d=line, stroke="#1f4e79", fill="none", stroke_width=2),
        element("text", number(low), x=_LEFT, y=_TOP + _HEIGHT + 14),
        element(
            "text",
            number(high),
            x=_WIDTH - _LEFT,
            y=_TOP + _HEIGHT + 14,
            text_anchor="end",
        ),
        width=_WIDTH,
        height=_TOP + _HEIGHT + 20,
    )


def _scatter(found: CalibratedStudy) -> str:
    model = found.model
    both = []
    for name, values in (("before", found.before), ("after", found.after)):
        pairs = model.pairs.where(np.arange(len(model.measured)))
        pairs = type(pairs)(**{**vars(pairs), "simulated": values})
        below = np.zeros(len(pairs.names), int)
        both.append(Comparison(name, pairs, below, Rules(), {}, (), False, 60.0))
    figure = scatter_figure(both, ILLUMINANCE)
    return image_address(figure_png(figure, dpi=110)) if figure else ""
