"""`clerestory irradiance` against `rtrace -I`, in a room with coloured walls."""

import csv
import io
from pathlib import Path

import numpy as np
from radiance import run

from clerestory.cli.main import main

ROOM = Path(__file__).parents[1] / "cli" / "room"
RUNS = 64
COLOURED = "void plastic grey 0 0 5 .6 .4 .2 0 0"


def test_sensors_of_a_room_receive_what_rtrace_says(tmp_path, capsys):
    """Overcast sky, one reflection; rtrace without interpolation, 64 times."""
    text = (ROOM / "room.rad").read_text()
    text = text.replace("void plastic grey\n0\n0\n5 0.5 0.5 0.5 0 0", COLOURED)
    assert COLOURED in text
    (tmp_path / "room.rad").write_text(text)
    sky = "gensky 3 21 12 -c -B 50"
    (tmp_path / "sky.rad").write_text(
        f"!{sky}\nskyfunc glow sky 0 0 4 1 1 1 0\nsky source up 0 0 4 0 0 1 180\n"
    )
    points = (ROOM / "desk.pts").read_text()
    run("oconv room.rad sky.rad > room.oct", folder=tmp_path)
    options = "-h -I -u+ -ab 2 -ad 512 -lw 1e-7 -aa 0 -as 0 -dt 0"
    output = run(f"rtrace {options} room.oct", folder=tmp_path, stdin=points * RUNS)
    theirs = np.loadtxt(io.StringIO(output)).reshape(RUNS, -1, 3)
    status = main(
        [
            "irradiance", "--scene", str(tmp_path / "room.rad"),
            "--sky", str(tmp_path / "sky.rad"),
            "--sensors", str(ROOM / "desk.pts"), "--bounces", "2",
            "--relative-error", "0.004",
        ]
    )  # fmt: skip
    assert status == 0
    rows = list(csv.DictReader(io.StringIO(capsys.readouterr().out)))
    mean, spread = np.mean(theirs, axis=0), np.std(theirs, axis=0, ddof=1) / RUNS**0.5
    for sensor, row in enumerate(rows):
        for number, band in enumerate(("red", "green", "blue")):
            ours, error = float(row[f"{band}_W_m2"]), float(row[f"error_{band}_W_m2"])
            both = np.hypot(error, spread[sensor, number])
            assert both < 0.03 * ours
            assert abs(ours - mean[sensor, number]) < 4 * both
