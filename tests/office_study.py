"""Files of a study: an office of three spaces, two orientations and four tilts."""

import shutil
from importlib import resources

import clerestory as cl
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.bsdfgen.venetian_geometry import venetian

TILTS = (0, 30, 60, 80)

MATERIALS = """
void plastic wall 0 0 5 .5 .5 .5 0 0
void plastic floor 0 0 5 .2 .2 .2 0 0
void plastic ceiling 0 0 5 .8 .8 .8 0 0
void plastic brick 0 0 5 .3 .3 .3 0 0
"""

STUDY = """title = "Office of three spaces"
method = "5-phase"

[scene]
files = ["materials.rad", "rooms.rad"]

[weather]
file = "{weather}"

[sky]
subdivision = 1

[trace]
samples = {samples}
seed = 3

[sun]
samples = 256
tolerance_deg = 5

[compliance]
standards = ["LM-83", "LEED v4", "LEED v4.1", "EN 17037", "BREEAM"]
"""


def write_office(folder, weather, *, samples=256, spacing=0.5, views=True):
    """Write the study and all its files; return the path of the study file."""
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "materials.rad").write_text(MATERIALS)
    rooms = [room("a", 0, 4), room("b", 4.1, 8.1), room("c", 8.2, 12.2, east=True)]
    building = quad("brick", "opposite", (-20, -20, -3), (40, 0, 0), (0, 0, 11))
    (folder / "rooms.rad").write_text("".join([*rooms, building]))
    pane = resources.files("clerestory") / "demo" / "double_pane.xml"
    shutil.copy(str(pane), folder / "open.xml")
    for tilt in TILTS:
        blind = venetian(slat_width=0.08, spacing=0.072, tilt_deg=tilt, reflectance=0.5)
        traced = cl.generate_bsdf(blind, samples=64, seed=1, basis="quarter")
        write_bsdf(folder / f"tilt{tilt}.xml", traced, digits=5)
    text = STUDY.format(weather=weather, samples=samples)
    windows = {
        "a": ((1, 0, 0.9), (2, 0, 0), (0, 0, 1.5)),
        "b": ((5.1, 0, 0.9), (2, 0, 0), (0, 0, 1.5)),
        "c": ((12.2, 1.5, 0.9), (0, 2, 0), (0, 0, 1.5)),
    }
    for name, corner in windows.items():
        start = {"a": 0.0, "b": 4.1, "c": 8.2}[name]
        # The cross product of the edges points out of the room
        (folder / f"{name}.rad").write_text(quad("void", name, *corner, turned=True))
        (folder / f"{name}.pts").write_text(grid(start, spacing))
        text += f'\n[[sensors]]\nfile = "{name}.pts"\nname = "room {name}"\n'
        text += f'\n[[window]]\nfile = "{name}.rad"\nname = "window {name}"\n'
        text += '[[window.state]]\nname = "raised"\nbsdf = "open.xml"\n'
        for tilt in TILTS:
            text += f'[[window.state]]\nname = "tilt {tilt}"\nbsdf = "tilt{tilt}.xml"\n'
        text += f'[window.control]\nrule = "LM-83"\ngrid = "room {name}"\n'
        if views:
            towards = "1 0 0" if name == "c" else "0 -1 0"
            view = f"rvu -vta -vp {start + 2} 2 1.2 -vd {towards} -vu 0 0 1"
            view += " -vh 180 -vv 180"
            (folder / f"{name}.vf").write_text(f"{view}\n")
            text += f'\n[[view]]\nfile = "{name}.vf"\nname = "desk {name}"\n'
            text += "resolution = 32\nsamples = 16\n"
    path = folder / "study.toml"
    path.write_text(text)
    return path


def room(name, x0, x1, *, east=False):
    """Room 5 m deep and 2.8 m high, with a hole for a window of 2 m × 1.5 m."""
    wide = (x1 - x0, 0, 0)
    hole = {"south": not east, "east": east}
    deep, high = (0, 5, 0), (0, 0, 2.8)
    parts = [
        quad("floor", f"{name}_floor", (x0, 0, 0), wide, deep),
        quad("ceiling", f"{name}_ceiling", (x0, 0, 2.8), wide, deep),
        quad("wall", f"{name}_north", (x0, 5, 0), wide, high),
        quad("wall", f"{name}_west", (x0, 0, 0), deep, high),
    ]
    for side, start, along, first, size in (
        ("south", (x0, 0, 0), wide, 1.0, x1 - x0),
        ("east", (x1, 0, 0), deep, 1.5, 5.0),
    ):
        if not hole[side]:
            parts.append(quad("wall", f"{name}_{side}", start, along, high))
            continue
        unit = tuple(a / size for a in along)
        for k, (u, v, w, h) in enumerate(
            (
                (0, 0, size, 0.9),
                (0, 2.4, size, 0.4),
                (0, 0.9, first, 1.5),
                (first + 2, 0.9, size - first - 2, 1.5),
            )
        ):
            corner = tuple(s + u * d for s, d in zip(start, unit, strict=True))
            corner = (corner[0], corner[1], v)
            edge = tuple(w * d for d in unit)
            parts.append(quad("wall", f"{name}_{side}{k}", corner, edge, (0, 0, h)))
    return "".join(parts)


def quad(material, name, corner, along, across, *, turned=False):
    """Return a parallelogram; `turned` reverses its front."""
    a, b, c = (list(map(float, p)) for p in (corner, along, across))
    points = [a, add(a, b), add(add(a, b), c), add(a, c)]
    points = points[::-1] if turned else points
    numbers = " ".join(f"{x:g}" for point in points for x in point)
    return f"\n{material} polygon {name} 0 0 12 {numbers}\n"


def add(a, b):
    return [x + y for x, y in zip(a, b, strict=True)]


def grid(start, spacing):
    """Sensors 0.8 m above the floor, half a spacing from the walls and further on."""
    count = round(4 / spacing), round(5 / spacing)
    lines = [
        f"{start + (i + 0.5) * spacing:g} {(j + 0.5) * spacing:g} 0.8 0 0 1"
        for j in range(count[1])
        for i in range(count[0])
    ]
    return "\n".join(lines) + "\n"
