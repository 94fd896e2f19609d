"""A course of the year in closed form: states, glare, terms, pictures to be shown.

A blind of three states follows the clock, DGP grows with the hour from 6 to 18 from
0.2 to 0.5, the direct sun stands at one sensor around noon, and pictures are grey but
for one bright square.
"""

import json

import numpy as np
import xarray as xr

from clerestory.image.picture import Picture
from clerestory.image.picture_files import write_picture
from clerestory.scene.view import View
from clerestory.study.results import Results

STATES = ("open", "tilted", "closed")
VIEWS = ("desk", "door")


def hours(times):
    return (times - times.astype("datetime64[D]")) / np.timedelta64(1, "h")


def dgp(times):
    hour = hours(times)
    lit = (hour > 6) & (hour < 18)
    return np.where(lit, 0.2 + 0.3 * (hour - 6) / 12, np.nan)


def state(times):
    hour = hours(times)
    return np.select([hour < 10, hour < 14], [0, 1], default=2).astype(np.int8)


def with_course(results, *, pictures=()):
    """Add states, glare of two views and the equation's terms to results."""
    data = results.data
    times = data["time"].values
    seen = np.stack([dgp(times), *(0 * dgp(times) + 0.1 for _ in VIEWS[1:])])
    lux = data["illuminance"]
    noon = np.abs(hours(times) - 12) < 1
    spread = 0 * lux + 5 * noon
    sun = 0 * lux + 0.0
    sun[3] = 2000.0 * noon
    study = json.loads(data.attrs["study"])
    study["method"] = "5-phase"
    study["view"] = [{"name": view, "pictures": list(pictures)} for view in VIEWS]
    study["window"][0]["control"] = {"rule": "cut-off", "tilts_deg": [0.0, 45.0, 90.0]}
    more = xr.Dataset(
        {
            "state": (("window", "time"), state(times)[None]),
            "state_name": (("window", "state_number"), [[*STATES, ""]]),
            "layer_transmission": (
                ("layer", "exit", "incident"),
                np.stack([np.full((145, 145), tau / np.pi) for tau in (0.6, 0.2)]),
            ),
            "glare_dgp": (("view", "time"), seen),
            "glare_illuminance": (("view", "time"), 5000 * seen),
            "glare_brightest_luminance": (("view", "time"), 9000 * seen),
            "three_phase": lux - sun + spread,
            "direct_in_patches": spread,
            "direct_sun": sun,
            "dimming": (("zone", "time"), np.where(hours(times) < 10, 0.5, 0)[None]),
            "lighting_energy": ("zone", [12_340.0]),
            "lighting_energy_error": ("zone", [56.0]),
        },
        coords={
            "view": list(VIEWS),
            "zone": ["inner"],
            "layer": ["south: open", "south: closed"],
        },
    )
    attrs = {**data.attrs, "study": json.dumps(study), "method": "5-phase"}
    return Results(xr.merge([data, more]).assign_attrs(attrs), results.run)


def write_pictures(folder, moments, *, size=(40, 60), views=VIEWS):
    """Pictures of 179 cd/m² times the hour, with a square a hundred times as bright."""
    folder.mkdir(exist_ok=True)
    for view in views:
        for moment in moments:
            level = np.full((*size, 3), float(moment[6:8]), dtype=np.float32)
            level[5:10, 5:10] *= 100
            seen = View(kind="perspective", horizontal=60, vertical=40)
            name = f"{view}_{moment.replace(':', '')}.hdr"
            write_picture(Picture(level, view=seen), folder / name)
