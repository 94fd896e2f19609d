"""Meteorological seasons, for shades that are set a few times a year.

Each season is three whole months: winter of the northern hemisphere is December to
February, that of the southern one June to August (World Meteorological Organization,
Guide to Climatological Practices, WMO-No. 100, 2018).
"""

import numpy as np
from jaxtyping import Int

SEASONS = ("winter", "spring", "summer", "autumn")


def season_numbers(
    times: np.ndarray, *, latitude_deg: float = 45.0
) -> Int[np.ndarray, " time"]:
    """Return the index in `SEASONS` of each time.

    >>> days = np.array(["2023-01-15", "2023-06-01", "2023-12-01"], "M8[D]")
    >>> [SEASONS[k] for k in season_numbers(days)]
    ['winter', 'summer', 'winter']
    >>> [SEASONS[k] for k in season_numbers(days, latitude_deg=-33.9)]
    ['summer', 'winter', 'summer']
    """
    months = times.astype("datetime64[M]").astype(int) % 12 + 1
    northern = months % 12 // 3
    return np.asarray((northern + 2 * (latitude_deg < 0)) % 4)
