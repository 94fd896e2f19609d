"""Annual electric lighting: dimming of each zone of luminaires."""

import numpy as np
import xarray as xr
from matplotlib import colormaps

from clerestory.report.class_map import DayMap
from clerestory.report.content import ReportContent
from clerestory.report.markup import render
from clerestory.report.section import Section
from clerestory.report.uncertain_value import Figure

_LEVELS = 101


def lamps_section(content: ReportContent) -> Section:
    """Return the section of electric lighting; empty without luminaires."""
    if "dimming" not in content.data:
        return Section()
    colours = colormaps["YlOrBr"](np.linspace(0.0, 0.85, _LEVELS))[:, :3]
    zones, maps = [], []
    for number, name in enumerate(content.data["zone"].values.tolist()):
        zone = content.data.sel(zone=name)
        percentage = 100 * np.clip(zone["dimming"].values.astype(float), 0, 1)
        maps.append(
            DayMap(
                f"lamps-{number}",
                f"Output of the luminaires of {name} by day and hour",
                np.round(percentage).astype(int),
                tuple(f"output {k} %" for k in range(_LEVELS)),
                np.round(255 * colours).astype(np.uint8),
            )
        )
        drawing = maps[-1].drawing(content.grid, occupied=content.occupied)
        zones.append({"name": name, "text": _words(zone, content), "map": drawing})
    return Section(render("lamps.html", zones=zones), maps=maps)


def _words(zone: xr.Dataset, content: ReportContent) -> str:
    # Sentences on the mean light output and the energy of a zone of luminaires
    output = zone["dimming"].values.astype(float)[content.occupied]
    off = 100 * float((output <= 0).mean())
    full = content.grid.hours(content.occupied) * float(output.mean())
    words = (
        f"In the occupied hours the luminaires emit {100 * output.mean():.1f} % of"
        f" their full output on average, as much as in {full:,.0f} hours at full"
        f" output; they are off in {off:.1f} % of the hours."
    )
    if "lighting_energy" in zone:
        value, error = zone["lighting_energy"], zone["lighting_energy_error"]
        energy = Figure(float(value) / 1000, float(error) / 1000, "kWh")
        words += f" Their energy over all time steps is {energy}."
    return words
