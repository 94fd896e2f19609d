"""`clerestory compare` of finished runs."""

import csv

import pytest


@pytest.fixture
def runs(call, room):
    """Runs of the room with its floor, and with a darker one in a file of that name."""
    assert call("run", "study.toml", "--out", "light", "--quiet").status == 0
    scene = room / "room.rad"
    text = scene.read_text()
    scene.write_text(text.replace("5 0.5 0.5 0.5 0 0", "5 0.2 0.2 0.2 0 0"))
    assert scene.read_text() != text
    assert call("run", "study.toml", "--out", "dark", "--quiet").status == 0
    return "light", "dark"


@pytest.mark.slow
def test_edited_files_are_told_apart_by_their_content(call, room, runs):
    done = call("compare", *runs, "-o", "both")
    assert done.status == 0, done.err
    with (room / "both/variants.csv").open() as stream:
        rows = list(csv.DictReader(stream))
    settings = {row["variant"]: row["scene.files"] for row in rows}
    assert set(settings) == {"light", "dark"}
    light, dark = settings["light"], settings["dark"]
    assert light != dark
    assert light.split(" (")[0] == dark.split(" (")[0]
    mean = {r["variant"]: float(r["value"]) for r in rows if r["unit"] == "lux"}
    assert mean["dark"] < mean["light"]
