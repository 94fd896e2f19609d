"""Measured spectra of daylight over time, interpolated to the time steps of a study.

Only the shape of a spectrum is used: its level is set by the weather data.
"""

from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import final

import numpy as np
from jaxtyping import Bool, Float

from clerestory.brief_repr import brief
from clerestory.checks import finite, has_shape, not_negative, require
from clerestory.errors import InputError, located
from clerestory.files import read_text
from clerestory.spectra import check_wavelengths, interpolation_matrix
from clerestory.spectral.functions import WAVELENGTH_NM

# Largest distance in time of a time step with light from a measured spectrum [s]
_FARTHEST = 3600.0


@final
@dataclass(frozen=True, eq=False)
class MeasuredSpectra:
    """Spectra of the light of the sky, or of the sun, at increasing times.

    Attributes
    ----------
    times : times in local standard time
    wavelength_nm : wavelengths [nm]
    power : spectral power, in any unit

    Raises
    ------
    InputError : times or wavelengths do not increase, a value is negative, a spectrum
        is zero, or the shape is wrong
    """

    times: np.ndarray
    wavelength_nm: Float[np.ndarray, " wavelength"]
    power: Float[np.ndarray, "record wavelength"]

    __repr__ = brief

    def __post_init__(self) -> None:
        check_wavelengths(self.wavelength_nm)
        times = np.asarray(self.times).astype("datetime64[s]")
        object.__setattr__(self, "times", times)
        shape = len(times), len(self.wavelength_nm)
        has_shape(self.power, shape, "array of spectra", error=InputError)
        require(len(times), "no spectra; one or more expected")
        finite(self.power, "a value of a spectrum")
        not_negative(self.power, "a value of a spectrum")
        late = np.flatnonzero(np.diff(times) <= np.timedelta64(0, "s"))
        if len(late):
            raise InputError(
                f"the spectrum of {times[late[0] + 1]} follows that of"
                f" {times[late[0]]}; increasing times expected"
            )
        dark = np.flatnonzero(self.power.sum(axis=1) <= 0)
        if len(dark):
            raise InputError(
                f"the spectrum of {times[dark[0]]} is zero; light, or no line for this"
                " time, expected"
            )

    def at(
        self, times: np.ndarray, lit: Bool[np.ndarray, " time"]
    ) -> Float[np.ndarray, "time wavelength"]:
        """Spectra at `WAVELENGTH_NM`, interpolated in time; total power is 1.

        Raises
        ------
        InputError : a time step with light is more than an hour from the next record
        """
        known = self.times.astype(float)
        wanted = times.astype("datetime64[s]").astype(float)
        after = np.clip(np.searchsorted(known, wanted), 0, len(known) - 1)
        before = np.maximum(after - 1, 0)
        gaps = np.abs(known[[before, after]] - wanted)
        far = np.flatnonzero(lit & (gaps.min(axis=0) > _FARTHEST))
        if len(far):
            raise InputError(
                f"no measured spectrum within an hour of {times[far[0]]}, a time step"
                f" with light; spectra from {self.times[0]} to {self.times[-1]} given"
            )
        share = np.interp(wanted, known, np.arange(len(known)))
        onto = interpolation_matrix(self.wavelength_nm, WAVELENGTH_NM)
        shape = self.power / self.power.sum(axis=1, keepdims=True)
        low = np.floor(share).astype(int)
        high = np.minimum(low + 1, len(known) - 1)
        part = (share - low)[:, None]
        mixed = (1 - part) * shape[low] + part * shape[high]
        return np.asarray(mixed @ onto.T)


def read_measured_spectra(path: str | Path) -> MeasuredSpectra:
    r"""Read measured spectra from a CSV file.

    The first line has `time` and the wavelengths [nm], every other line a time in local
    standard time, such as 2026-06-20T12:00, and the values. Blank lines and what
    follows a # are ignored.

    Raises
    ------
    InputError : the file is missing, or a line is not as above

    Examples
    --------
    >>> import tempfile
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "sky.csv")
    ...     _ = file.write_text("time,400,700\n2026-06-20T12:00,2,1\n")
    ...     read_measured_spectra(file).power.tolist()
    [[2.0, 1.0]]
    """
    times: list[np.datetime64] = []
    rows: list[list[float]] = []
    wavelengths: list[float] | None = None
    for number, line in enumerate(read_text(path).split("\n"), start=1):
        cells = [cell.strip() for cell in line.partition("#")[0].split(",")]
        if not any(cells):
            continue
        with located(file=path, line=number):
            if wavelengths is None:
                require(
                    cells[0].lower() == "time",
                    f'the line begins with "{cells[0][:40]}"; time, and wavelengths'
                    " [nm], expected",
                )
                wavelengths = _numbers(cells[1:])
                continue
            require(
                len(cells) == len(wavelengths) + 1,
                f"the line has {len(cells) - 1} values; {len(wavelengths)} expected",
            )
            times.append(_time(cells[0]))
            rows.append(_numbers(cells[1:]))
    require(
        rows,
        "no spectra; a line of wavelengths and lines of values expected",
        file=path,
    )
    with located(file=path):
        values = np.array(rows).reshape(len(rows), -1)
        return MeasuredSpectra(np.array(times), np.array(wavelengths), values)


def _numbers(cells: list[str]) -> list[float]:
    try:
        return [float(cell) for cell in cells]
    except ValueError:
        shown = ", ".join(cells)[:60]
        raise InputError(f'the values are "{shown}"; numbers expected') from None


def _time(cell: str) -> np.datetime64:
    with suppress(ValueError):
        found = np.datetime64(cell, "s")
        if not np.isnat(found):
            return found
    raise InputError(
        f'the time is "{cell[:40]}"; a time such as 2026-06-20T12:00 expected'
    )
