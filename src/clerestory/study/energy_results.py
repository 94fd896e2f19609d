"""Labelled results of EnergyPlus: energy, peaks, comfort, and radiation of windows."""

from collections.abc import Sequence

import numpy as np
import xarray as xr
from jaxtyping import Bool, Float

from clerestory.study.energy_solar import PARTS, SolarRadiation

# Share of the incident radiation above which windows count for the balance [W/m²]
_LIT = 1.0


def energy_results(
    uses: Sequence[str], energy: Float[np.ndarray, "use time"], hours: float
) -> xr.Dataset:
    """Return energy over time and in the year [kWh], and peak power [kW]."""
    axes = "energy_use", "time"
    return xr.Dataset(
        {
            "energy": (axes, energy.astype(np.float32), {"units": "kWh"}),
            "annual_energy": (axes[0], np.nansum(energy, axis=1), {"units": "kWh"}),
            "peak_power": (axes[0], _largest(energy) / hours, {"units": "kW"}),
        },
        coords={axes[0]: list(uses)},
    )


def comfort_results(
    temperature: Float[np.ndarray, "zone time"],
    zones: Sequence[str],
    occupied: Bool[np.ndarray, " time"],
    hours: float,
    limits: tuple[float, float],
) -> xr.Dataset:
    """Return operative temperatures [°C], and occupied hours outside the limits [h]."""
    outside = (temperature < limits[0]) | (temperature > limits[1])
    spent = (outside & occupied).sum(axis=1) * hours
    axes, values = ("thermal_zone", "time"), temperature.astype(np.float32)
    return xr.Dataset(
        {
            "operative_temperature": (axes, values, {"units": "degree_Celsius"}),
            "hours_out_of_comfort": (
                axes[0],
                spent,
                {"units": "h", "comfort_c": list(limits)},
            ),
        },
        coords={axes[0]: np.array(zones, dtype=str)},
    )


def solar_results(
    parts: Sequence[str],
    solar: Float[np.ndarray, "part window time"],
    windows: Sequence[str],
    hours: float,
) -> xr.Dataset:
    """Return the solar radiation of windows by part [W], and in the year [kWh]."""
    axes = "solar_part", "energy_window", "time"
    kwh = np.nansum(solar, axis=2) * hours / 1000
    return xr.Dataset(
        {
            "window_solar": (axes, solar.astype(np.float32), {"units": "W"}),
            "annual_window_solar": (axes[:2], kwh, {"units": "kWh"}),
        },
        coords={axes[0]: list(parts), axes[1]: np.array(windows, dtype=str)},
    )


def matrix_solar_results(solar: SolarRadiation, hours: float) -> xr.Dataset:
    """Return the radiation of windows and of their layers, from a study's matrices.

    `annual_layer_solar` [kWh] is what each layer absorbs, `solar_balance` the largest
    relative error of the energy balance of a window over all time steps with sun, and
    `zone_closure` the share of the radiation absorbed in zones before its scaling.
    """
    area = np.array([each.window.area for each in solar.windows])
    parts = np.array([[each.parts[part] for each in solar.windows] for part in PARTS])
    names = [each.window.name for each in solar.windows]
    found = solar_results(PARTS, parts * area[None, :, None], names, hours)
    most = max(len(each.layers) for each in solar.windows)
    layers = np.zeros((len(names), most))
    for row, each in zip(layers, solar.windows, strict=True):
        row[: len(each.layers)] = each.layers.sum(axis=1)
    kwh = layers * area[:, None] * hours / 1000
    balance = [
        float(np.nanmax(np.abs(each.balance), initial=0.0, where=lit))
        if np.isfinite(each.balance[lit]).all()
        else np.nan
        for each in solar.windows
        for lit in [each.parts["incident"] > _LIT]
    ]
    return found.assign(
        {
            "annual_layer_solar": (
                ("energy_window", "solar_layer"),
                kwh,
                {"units": "kWh"},
            ),
            "solar_balance": ("energy_window", np.array(balance)),
            "zone_closure": ("solar_zone", np.array(list(solar.closure.values()))),
        }
    ).assign_coords(solar_zone=list(solar.closure))


def _largest(energy: Float[np.ndarray, "use time"]) -> Float[np.ndarray, " use"]:
    # Largest value over time; NaN for outputs that the model does not have
    known = ~np.isnan(energy).all(axis=1)
    found = np.full(len(energy), np.nan)
    found[known] = np.nanmax(energy[known], axis=1)
    return found
