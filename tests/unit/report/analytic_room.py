"""Results of a room that needs no tracing: a window to a uniform sky, in closed form.

A level sensor at the distance D from a window without glass receives from a
uniform sky of luminance L, from each strip between the sensor's height and H that
runs from the foot of its normal W to one side,

    E = L/2 · (atan(W/D) − D/√(D² + H²) · atan(W/√(D² + H²)))

(R. G. Hopkinson, P. Petherbridge, J. Longmore, Daylighting, 1966, chapter 3).
"""

import json

import numpy as np
import xarray as xr

from clerestory.metrics.occupied_hours import occupied_hours
from clerestory.metrics.sensor_metrics import sensor_metrics
from clerestory.study.results import Results

WIDTH, DEPTH, HEIGHT = 6.1, 9.1, 2.7
SILL, HEAD = 0.85, 2.65
BOUNCED = 0.006  # of π L, everywhere


def year(step_minutes=60, days=365, first="2023-01-01"):
    count = days * 24 * 60 // step_minutes
    step = np.timedelta64(step_minutes * 30, "s")
    return np.datetime64(f"{first}T00:00:00") + (2 * np.arange(count) + 1) * step


def sky_luminance(times):
    """Luminance [cd/m²] that follows the height of the sun at 36° north."""
    day = (times - times.astype("datetime64[Y]")) / np.timedelta64(1, "D")
    hour = 24 * (day % 1)
    declination = np.radians(23.44) * np.sin(2 * np.pi * (day - 81) / 365)
    latitude = np.radians(36.1)
    height = np.sin(latitude) * np.sin(declination) + np.cos(latitude) * np.cos(
        declination
    ) * np.cos(np.radians(15 * (hour - 12)))
    clouds = 0.55 + 0.45 * np.sin(2.1 * np.floor(day)) * np.cos(0.37 * np.floor(day))
    return 14_000 * np.clip(height, 0, 1) * (0.35 + clouds)


def sky_factor(points):
    """Share of π L that reaches level sensors through the window in y = 0."""
    x, y, z = points.T
    total = np.full(len(points), BOUNCED)
    for wide in (x, WIDTH - x):
        for high, sign in ((HEAD - z, 1), (np.maximum(SILL - z, 0), -1)):
            far = np.hypot(y, high)
            strip = np.arctan2(wide, y) - y / far * np.arctan2(wide, far)
            total += sign * strip / (2 * np.pi)
    return total


def quad(*corners):
    a, b, c, d = (np.array(p, float) for p in corners)
    return [np.stack([a, b, c]), np.stack([a, c, d])]


def box(low, high):
    (x0, y0, z0), (x1, y1, z1) = low, high
    return (
        quad((x0, y0, z0), (x0, y1, z0), (x1, y1, z0), (x1, y0, z0))
        + quad((x0, y0, z1), (x1, y0, z1), (x1, y1, z1), (x0, y1, z1))
        + quad((x0, y0, z0), (x1, y0, z0), (x1, y0, z1), (x0, y0, z1))
        + quad((x1, y0, z0), (x1, y1, z0), (x1, y1, z1), (x1, y0, z1))
        + quad((x1, y1, z0), (x0, y1, z0), (x0, y1, z1), (x1, y1, z1))
        + quad((x0, y1, z0), (x0, y0, z0), (x0, y0, z1), (x0, y1, z1))
    )


def room_triangles():
    w, d, h = WIDTH, DEPTH, HEIGHT
    parts = [
        (0.23, quad((0, 0, 0), (w, 0, 0), (w, d, 0), (0, d, 0))),
        (0.82, quad((0, 0, h), (0, d, h), (w, d, h), (w, 0, h))),
        (0.62, quad((0, 0, 0), (0, d, 0), (0, d, h), (0, 0, h))),
        (0.62, quad((w, d, 0), (w, 0, 0), (w, 0, h), (w, d, h))),
        (0.62, quad((w, d, 0), (w, d, h), (0, d, h), (0, d, 0))),
        (0.62, quad((0, 0, 0), (0, 0, SILL), (w, 0, SILL), (w, 0, 0))),
        (0.62, quad((0, 0, HEAD), (0, 0, h), (w, 0, h), (w, 0, HEAD))),
        (0.2, quad((-40, -40, -0.3), (40, -40, -0.3), (40, 40, -0.3), (-40, 40, -0.3))),
    ]
    for x in (0.2, 2.25, 4.3):
        for y in (1.5, 4.1, 6.7):
            parts.append((0.5, box((x, y, 0.7), (x + 1.6, y + 0.8, 0.73))))
            parts.append((0.35, box((x, y + 0.82, 0), (x + 1.6, y + 0.86, 1.15))))
    corners = np.array([t for _, triangles in parts for t in triangles])
    grey = np.concatenate([[rho] * len(triangles) for rho, triangles in parts])
    return corners, np.repeat(grey[:, None], 3, axis=1)


def desk_points(spacing=0.8):
    x = np.arange(0.65, WIDTH - 0.2, spacing)
    y = np.arange(0.55, DEPTH - 0.2, spacing)
    return np.array([[a, b, 0.76] for b in y for a in x])


def analytic_results(
    *,
    title="FLEXLAB test room, open window",
    times=None,
    points=None,
    with_eyes=True,
    inward=True,
    luminance=None,
    run=None,
):
    """Return results as a run would; `inward` False turns the window round."""
    times = year() if times is None else times
    points = desk_points() if points is None else points
    names = [f"desks.{k + 1}" for k in range(len(points))]
    direction = np.tile([0.0, 0, 1], (len(points), 1))
    factor = sky_factor(points)
    if with_eyes:
        eyes = np.array(
            [[3.05, 1.2, 1.2], [3.05, 1.2, 1.2], [3.05, 4.0, 1.2], [3.05, 6.8, 1.2]]
        )
        direction = np.concatenate(
            [direction, [[-1, 0, 0], [1, 0, 0], [0, -1, 0], [0, -1, 0]]]
        )
        factor = np.concatenate([factor, 0.9 * sky_factor(eyes)])
        names += [f"eyes.{k + 1}" for k in range(4)]
        points = np.concatenate([points, eyes])
    grids = [name.split(".")[0] for name in names]
    sky = sky_luminance(times) if luminance is None else luminance
    lux = (np.pi * factor[:, None] * sky).astype(np.float32)
    spread = 0.003 + 0.002 * np.random.default_rng(1).gamma(3, size=lux.shape)

    corners, colour = room_triangles()
    normal = np.array([0.0, 1.0, 0.0]) * (1 if inward else -1)
    window = np.array(
        quad((WIDTH, 0, SILL), (0, 0, SILL), (0, 0, HEAD), (WIDTH, 0, HEAD))
    )
    if not inward:
        window = window[:, ::-1]
    data = xr.Dataset(
        {
            "illuminance": (("sensor", "time"), lux),
            "standard_error": (("sensor", "time"), (spread * lux).astype(np.float32)),
            "occupied": ("time", occupied_hours(times)),
            "triangle": (("triangle", "corner", "xyz"), corners),
            "triangle_colour": (("triangle", "channel"), colour),
            "window_normal": (("window", "xyz"), normal[None]),
            "window_up": (("window", "xyz"), np.array([[0.0, 0, 1]])),
            "window_centre": (("window", "xyz"), window.mean(axis=(0, 1))[None]),
            "window_triangle": (("window_triangle", "corner", "xyz"), window),
            "window_index": ("window_triangle", [0, 0]),
        },
        coords={
            "sensor": names,
            "time": times,
            "grid": ("sensor", grids),
            "position": (("sensor", "xyz"), points),
            "direction": (("sensor", "xyz"), direction),
            "window": ["south"],
        },
    )
    study = {
        "title": title,
        "method": "3-phase",
        "scene": {"files": ["materials.rad", "room.rad"]},
        "window": [{"name": "south", "file": "window.rad", "bsdf": "open.xml"}],
        "sensors": [
            {"name": "desks", "file": "desks.pts"},
            {"name": "eyes", "file": "eyes.pts"},
        ],
        "weather": {"file": "uniform sky", "from": None, "to": None},
        "sky": {"subdivision": 4, "ground_reflectance": 0.2, "rotation_deg": 0.0},
        "trace": {
            "relative_error": 0.01,
            "samples": None,
            "bounces": None,
            "seed": 1,
            "device": "auto",
        },
        "schedule": {"from_hour": 8.0, "to_hour": 18.0},
        "metrics": {"target_lux": 300.0},
    }
    attrs = {
        "title": title,
        "method": "3-phase",
        "target_lux": 300.0,
        "study": json.dumps(study),
        "place": "Greensboro",
        "latitude_deg": 36.1,
        "longitude_deg": -79.95,
    }
    hours = occupied_hours(times)
    data = data.merge(
        sensor_metrics(data, hours if hours.any() else ~hours)
    ).assign_attrs(attrs)
    facts = {
        "versions": {
            "clerestory": "0.1.0",
            "mitsuba": "3.9.1",
            "drjit": "1.5.0",
            "python": "3.11.2",
        },
        "seed": 1,
        "device": "cpu: LLVM 23.1, 2 threads",
        "seconds": {
            "scene": 0.31,
            "view matrix": 4.2,
            "daylight matrix": 2.9,
            "sky matrix": 3.4,
            "product": 0.9,
            "report": 0.6,
        },
        "error": {"desks": 0.0097, "eyes": 0.0089},
        "warnings": [],
        "matrices": {"view-south-3f2a.nc": {"found": False}},
    }
    return Results(data, facts if run is None else run)
