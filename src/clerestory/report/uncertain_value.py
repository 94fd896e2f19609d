"""Text of values with standard errors, of numbers, and of settings."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

# Number of items above which lists are abbreviated to the first and last item
_MOST_ITEMS = 8

# Units of settings by the last word of their key
_UNITS = {"c": "°C", "cm": "cm", "deg": "°", "gb": "GB", "lux": "lux", "m": "m"}


@dataclass(frozen=True)
class Figure:
    """A value and its standard error, both in `unit`."""

    value: float
    error: float
    unit: str

    def __str__(self) -> str:
        """Value ± error and unit; the error determines the number of decimals.

        >>> str(Figure(612.34, 4.2, "lux")), str(Figure(57.96, 0.3, "%"))
        ('612 ± 4 lux', '58.0 ± 0.3 %')
        """
        if self.error <= 0:
            shown = f"{self.value:.1f}" if self.unit == "%" else number(self.value)
            return f"{shown} {self.unit}"
        digits = next((k for k in (0, 1) if self.error >= 0.95 / 10**k), 2)
        error = f"{self.error:,.{digits}f}" if self.error >= 0.005 else "<0.01"
        return f"{self.value:,.{digits}f} ± {error} {self.unit}"


def number(value: float) -> str:
    """Return a number as text: three digits, or no decimals from 100 upwards.

    >>> [number(x) for x in (12345.6, 345.67, 7.891, 0.04567, 0.0)]
    ['12,346', '346', '7.89', '0.0457', '0']
    """
    if abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.3g}"


def setting_label(key: str) -> str:
    """Return the name of a setting in the study file as words with a unit.

    >>> setting_label("tilt_deg"), setting_label("target_lux"), setting_label("seed")
    ('tilt [°]', 'target [lux]', 'seed')
    """
    name, _, last = key.rpartition("_")
    words = f"{name} [{_UNITS[last]}]" if name and last in _UNITS else key
    return words.replace("_", " ").replace("bsdf", "BSDF")


def setting_rows(settings: Mapping[str, Any]) -> tuple[tuple[str, str], ...]:
    """Return name and value of each setting whose value is not empty."""
    return tuple(
        (str(key), setting_words(value))
        for key, value in settings.items()
        if value not in (None, "", [], {})
    )


def setting_words(value: Any) -> str:
    """Return the value of a setting as one line of text."""
    if isinstance(value, bool):
        return "yes" if value else "no"
    if isinstance(value, float):
        return f"{value:.4g}"
    if isinstance(value, dict):
        rows = setting_rows(value)
        return ", ".join(f"{setting_label(key)} {text}" for key, text in rows)
    if isinstance(value, list | tuple):
        if len(value) > _MOST_ITEMS:
            ends = f"{setting_words(value[0])} to {setting_words(value[-1])}"
            return f"{len(value)}, {ends}"
        return ", ".join(map(setting_words, value))
    return str(value)
