"""A small room with an open window, three materials, and a study of a few days."""

from pathlib import Path

MATERIALS = {"floor": 0.3, "wall": 0.5, "ceiling": 0.7}

STUDY = """title = "Small room"
method = "2-phase"
sun = "patches"

[scene]
files = ["room.rad"]

[[sensors]]
name = "desks"
file = "desks.pts"

[weather]
from_hour = 8
to_hour = 18
{weather}

[sky]
subdivision = 1

[trace]
samples = {samples}
seed = 5
device = "cpu"

{more}
"""

# A year of clear skies
CLEAR = """from = "{first}"
to = "{last}"

[weather.clear_sky]
latitude_deg = 40
longitude_deg = 0
utc_offset_hours = 0"""

# Corners of the surfaces of a room of 4 m by 5 m by 2.8 m; the south wall at y = 0 has
# an opening of 2.4 m by 1.4 m
SURFACES = {
    "floor": ("floor", ((0, 0, 0), (4, 0, 0), (4, 5, 0), (0, 5, 0))),
    "ceiling": ("ceiling", ((0, 0, 2.8), (0, 5, 2.8), (4, 5, 2.8), (4, 0, 2.8))),
    "west": ("wall", ((0, 0, 0), (0, 5, 0), (0, 5, 2.8), (0, 0, 2.8))),
    "east": ("wall", ((4, 0, 0), (4, 0, 2.8), (4, 5, 2.8), (4, 5, 0))),
    "north": ("wall", ((0, 5, 0), (4, 5, 0), (4, 5, 2.8), (0, 5, 2.8))),
    "sill": ("wall", ((0, 0, 0), (0, 0, 1), (4, 0, 1), (4, 0, 0))),
    "head": ("wall", ((0, 0, 2.4), (0, 0, 2.8), (4, 0, 2.8), (4, 0, 2.4))),
    "left": ("wall", ((0, 0, 1), (0, 0, 2.4), (0.8, 0, 2.4), (0.8, 0, 1))),
    "right": ("wall", ((3.2, 0, 1), (3.2, 0, 2.4), (4, 0, 2.4), (4, 0, 1))),
}


def scene_text(reflectances):
    """Return the room as a Radiance scene."""
    lines = [
        f"void plastic {name} 0 0 5 {rho} {rho} {rho} 0 0"
        for name, rho in reflectances.items()
    ]
    for name, (material, corners) in SURFACES.items():
        numbers = " ".join(f"{x}" for corner in corners for x in corner)
        lines.append(f"{material} polygon {name} 0 0 {3 * len(corners)} {numbers}")
    return "\n".join(lines) + "\n"


def sensor_text():
    """Return 12 sensors facing up, 0.8 m above the floor."""
    return "".join(
        f"{x} {y} 0.8 0 0 1\n" for y in (0.8, 2, 3.2, 4.4) for x in (0.8, 2, 3.2)
    )


def write_room(
    folder,
    *,
    reflectances=MATERIALS,
    first="06-20",
    last="06-22",
    samples=2000,
    more="",
    weather="",
):
    """Write scene, sensors and study; return the path of the study file.

    `weather` are keys of the table [weather]; default: clear skies of some days.
    """
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "room.rad").write_text(scene_text(reflectances))
    (folder / "desks.pts").write_text(sensor_text())
    study = folder / "study.toml"
    weather = weather or CLEAR.format(first=first, last=last)
    study.write_text(STUDY.format(weather=weather, samples=samples, more=more))
    return study


def unknown(material, deviation, *, distribution="normal", more=""):
    """Return the table of an unknown reflectance."""
    width = f"standard_deviation = {deviation}"
    return f"""
[[uncertainty.unknown]]
kind = "reflectance"
material = "{material}"
distribution = "{distribution}"
{width}
{more}
"""
