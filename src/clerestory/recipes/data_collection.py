"""Hourly values of a year as data collections of ladybug."""

from collections.abc import Mapping
from typing import Any

import numpy as np


def hourly_collection(
    name: str,
    values: np.ndarray,
    *,
    unit: str,
    metadata: Mapping[str, str] | None = None,
) -> dict[str, Any]:
    """Return 8760 values as the JSON object of a ladybug data collection.

    >>> made = hourly_collection("Occupancy", np.zeros(8760), unit="fraction")
    >>> made["header"]["unit"], len(made["values"])
    ('fraction', 8760)
    """
    kind: dict[str, Any] = {"type": "GenericDataType", "name": name, "base_unit": unit}
    if unit == "%":
        kind = {"type": "DataType", "name": name, "data_type": "Fraction"}
    period = {
        "type": "AnalysisPeriod",
        **{"st_month": 1, "st_day": 1, "st_hour": 0},
        **{"end_month": 12, "end_day": 31, "end_hour": 23},
        **{"timestep": 1, "is_leap_year": False},
    }
    header = {
        "type": "Header",
        "data_type": kind,
        "unit": unit,
        "analysis_period": period,
        "metadata": dict(metadata or {}),
    }
    return {"type": "HourlyContinuous", "header": header, "values": values.tolist()}
