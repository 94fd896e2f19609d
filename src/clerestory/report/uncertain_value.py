"""Values with standard errors, and numbers rounded for display."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Figure:
    """A value and its standard error, both in `unit`."""

    value: float
    error: float
    unit: str

    def __str__(self) -> str:
        """Value and error, rounded according to the error.

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
    """Return a number rounded to about three digits.

    >>> [number(x) for x in (12345.6, 345.67, 7.891, 0.04567, 0.0)]
    ['12,346', '346', '7.89', '0.0457', '0']
    """
    if abs(value) >= 100:
        return f"{value:,.0f}"
    return f"{value:.3g}"
