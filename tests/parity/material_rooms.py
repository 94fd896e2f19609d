"""Rooms of one material, and what rtrace's sensors read in them.

A box open to the south has a west wall and a roof of the material m. A sky or a sun
lights it, or a window in the south.
"""

import numpy as np
from radiance import run

BOX = """
void plastic w 0 0 5 .5 .5 .5 0 0
w polygon floor 0 0 12 0 0 0 3 0 0 3 4 0 0 4 0
w polygon east 0 0 12 3 0 0 3 0 3 3 4 3 3 4 0
m polygon west 0 0 12 0 0 0 0 4 0 0 4 3 0 0 3
w polygon north 0 0 12 0 4 0 3 4 0 3 4 3 0 4 3
m polygon roof 0 0 12 0 0 3 0 4 3 3 4 3 3 0 3
"""
LIGHT = {
    "sky": (
        "void glow sky 0 0 4 3 2 1 0\nsky source sky 0 0 4 0 0 1 180\n"
        "void glow ground 0 0 4 .5 .5 .5 0\nground source ground 0 0 4 0 0 -1 180\n"
    ),
    "sun": "void light sun 0 0 3 2e5 2e5 2e5\nsun source sun 0 0 4 .3 -.5 .6 .533\n",
}
# A sun that rtrace finds by chance, with the rays of its ambient calculation
WIDE = "void glow sun 0 0 4 80 80 80 0\nsun source sun 0 0 4 .3 -.5 .6 30\n"
WINDOW = """#@rfluxmtx h=kf u=Z
void glow pane 0 0 4 1 1 1 0
pane polygon pane 0 0 12 0 0 0 0 0 3 3 0 3 3 0 0
"""
POSITION = np.array([[1, 1, 0.8], [2, 3, 0.8], [1.5, 2, 1.5], [1, 3.5, 1.5]])
DIRECTION = np.array([[0, 0, 1], [0, 0, 1], [-1, 0, 0], [0, -1, 0.0]])


def seen_by_radiance(folder, files, *, bounces, highlight=32, divisions=1024, jitter=0):
    """Mean irradiance of the sensors and its standard error, by rtrace."""
    again = 32
    rays = np.repeat(np.concatenate([POSITION, DIRECTION], axis=1), again, axis=0)
    seen = run(
        f"oconv {files} > room.oct; rtrace -h -w -I -ab {bounces} -aa 0 -as 0"
        f" -ad {divisions} -st 0 -ss {highlight} -lw 1e-9"
        f" -lr 12 -dj {jitter} -ds 0 -dc 1 -dt 0 room.oct",
        folder=folder,
        stdin="\n".join(" ".join(map(str, ray)) for ray in rays),
    )
    found = np.fromstring(seen, sep=" ").reshape(-1, again, 3)
    return found.mean(axis=1), found.std(axis=1, ddof=1) / np.sqrt(again)
