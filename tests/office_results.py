"""Results of an office of three spaces, made without tracing."""

import json

import numpy as np
import xarray as xr

HOURS = np.arange(8760)
TIMES = np.datetime64("2023-01-01T00:30", "ns") + HOURS * np.timedelta64(1, "h")
DAY = (HOURS % 24 >= 8) & (HOURS % 24 < 18)
SHAPES = {"north": (4, 5), "south": (5, 6), "corner": (3, 4)}


def office(*, lux=None, sun=None, spacing=0.5, control=None, study=None, **changes):
    """Return results of a year with every input of every standard.

    `lux` and `sun` are illuminance in the day by grid; `changes` replace variables,
    None removes them.
    """
    lux = {"north": 400.0, "south": 800.0, "corner": 200.0} | (lux or {})
    sun = {"north": 0.0, "south": 0.0, "corner": 0.0} | (sun or {})
    grids = [name for name, (a, b) in SHAPES.items() for _ in range(a * b)]
    places = [
        _places(shape, 20 * k, spacing) for k, shape in enumerate(SHAPES.values())
    ]
    count = len(grids)
    levels = np.array([lux[name] for name in grids])[:, None] * DAY
    hourly, once = ("sensor", "time"), ("sensor",)
    rule = {"rule": "LM-83", "sun_lux": 1000.0, "most_sensors": 0.02}
    tables = [
        {"name": name, "control": {**rule, "grid": name, **(control or {})}}
        for name in SHAPES
    ]
    facts = {
        "window": tables,
        "sensors": [{"name": name} for name in SHAPES],
        "weather": {"file": "oslo.epw"},
    } | (study or {})
    variables = {
        "illuminance": (hourly, levels),
        "standard_error": (hourly, 0.01 * levels),
        "occupied": ("time", DAY),
        "position": (("sensor", "xyz"), np.concatenate(places)),
        "direction": (("sensor", "xyz"), np.tile([0.0, 0, 1], (count, 1))),
        "grid": (once, grids),
        "space": (once, grids),
        "floor_area": (once, np.full(count, 0.25)),
        "height_above_floor": (once, np.full(count, 0.76)),
        "direct_open": (
            hourly,
            np.array([sun[name] for name in grids])[:, None] * DAY,
        ),
        "sun_hours": (once, np.zeros(count)),
        "daylight_hours": ("time", DAY),
        "daylight_factor": (once, np.full(count, 0.03)),
        "daylight_factor_error": (once, np.full(count, 0.0001)),
        "view_width": (once, np.full(count, 60.0)),
        "view_distance": (once, np.full(count, np.inf)),
        "view_layers": (once, np.full(count, 7)),
        "window_space": ("window", list(SHAPES)),
        "window_normal": (("window", "xyz"), np.tile([0.0, 1, 0], (3, 1))),
        "control": (
            "window",
            [facts["window"][k]["control"]["rule"] for k in range(3)],
        ),
        "state": (("window", "time"), np.zeros((3, 8760), np.int8)),
        "state_name": (("window", "state_number"), [["open", "closed"]] * 3),
        "view_space": ("view", list(SHAPES)),
        "glare_dgp": (("view", "time"), np.full((3, 8760), 0.30)),
        "glare_dgp_error": (("view", "time"), np.full((3, 8760), 0.001)),
        "opening_space": ("opening", list(SHAPES)),
        "sun_reaches": (("opening", "moment"), np.tile(np.arange(24) < 3, (3, 1))),
    }
    variables |= changes
    data = xr.Dataset(
        {name: value for name, value in variables.items() if value is not None},
        coords={"time": TIMES, "window": list(SHAPES), "view": list(SHAPES)},
        attrs={
            "step_minutes": 60.0,
            "place": "Oslo",
            "median_diffuse_lux": 15000.0,
            "study": json.dumps(facts),
        },
    )
    return data.set_coords(["grid", "position", "direction"])


def _places(shape, start, spacing):
    x, y = np.meshgrid(*(np.arange(n) * spacing for n in shape))
    return np.stack([x.ravel() + start, y.ravel(), 0 * x.ravel() + 0.76], axis=-1)
