"""Annual electric lighting: dimming of each zone of luminaires."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float
from matplotlib import colormaps

from clerestory.report.class_map import DayMap, day_map
from clerestory.report.markup import Markup, render
from clerestory.report.period import hours_in
from clerestory.report.uncertain_value import Figure

_LEVELS = 101


@dataclass(frozen=True, eq=False)
class LampZone:
    """Zone of luminaires controlled by one photosensor.

    Attributes
    ----------
    name : name of the zone
    output : light output in each time step relative to full output, 0…1
    energy : energy over all time steps [kWh], if known
    """

    name: str
    output: Float[np.ndarray, " time"]
    energy: Figure | None = None


def lamp_zones(data: xr.Dataset) -> tuple[LampZone, ...]:
    """Return the luminaire zones in the results; empty without luminaires."""
    if "dimming" not in data:
        return ()
    return tuple(
        LampZone(
            str(zone),
            np.asarray(data["dimming"].sel(zone=zone), dtype=float),
            _energy(data.sel(zone=zone)),
        )
        for zone in data["zone"].values
    )


def _energy(data: xr.Dataset) -> Figure | None:
    if "lighting_energy" not in data:
        return None
    value, error = (
        float(data[name]) / 1000
        for name in ("lighting_energy", "lighting_energy_error")
    )
    return Figure(value, error, "kWh")


def lamp_maps(zones: Sequence[LampZone]) -> list[DayMap]:
    """Return an annual map of the light output of each zone [%]."""
    shades = colormaps["YlOrBr"](np.linspace(0.0, 0.85, _LEVELS))[:, :3]
    colours = np.round(255 * shades).astype(np.uint8)
    texts = tuple(f"output {k} %" for k in range(_LEVELS))
    return [
        DayMap(
            f"lamps-{number}",
            f"Output of the luminaires of {zone.name} by day and hour",
            np.round(100 * np.clip(zone.output, 0, 1)).astype(int),
            texts,
            colours,
        )
        for number, zone in enumerate(zones)
    ]


def lamps_section(
    zones: Sequence[LampZone],
    times: np.ndarray,
    *,
    occupied: Bool[np.ndarray, " time"],
) -> Markup:
    """Return the section of electric lighting."""
    if not zones:
        return Markup("")
    return render(
        "lamps.html",
        zones=[
            {
                "name": zone.name,
                "text": lamp_words(zone, times, occupied),
                "map": day_map(shown, times, occupied=occupied),
            }
            for zone, shown in zip(zones, lamp_maps(zones), strict=True)
        ],
    )


def lamp_words(
    zone: LampZone, times: np.ndarray, occupied: Bool[np.ndarray, " time"]
) -> str:
    """Return the annual output of a zone in words."""
    output = zone.output[occupied]
    off = 100 * float((output <= 0).mean())
    full = hours_in(times, occupied) * float(output.mean())
    return (
        f"In the occupied hours the luminaires give {100 * output.mean():.1f} % of"
        f" their light on average, as much as {full:,.0f} hours at full output;"
        f" in {off:.1f} % of the hours they are off."
        + (f" In all they take {zone.energy}." if zone.energy else "")
    )
