"""`clerestory luminaire`: what files hold, and their diagrams."""

import pytest

LAMP = """IESNA:LM-63-2002
[MANUFAC] Acme
[LUMCAT] Spot 7
TILT=NONE
1 1000 1 3 1 1 2 -.2 -.2 0
1 1 20
0 45 90
0
100 80 0
"""


@pytest.fixture
def lamp(room):
    (room / "lamp.ies").write_text(LAMP)
    return "lamp.ies"


def test_files_are_described(call, lamp):
    """328 lm is 2π times the integral of the two straight pieces, times sin θ."""
    outcome = call("luminaire", "info", lamp)
    assert outcome.status == 0
    assert outcome.out.splitlines() == [
        "lamp.ies: Spot 7",
        "  manufacturer: Acme",
        "  flux: 328 lm, 32.8% of the 1000 lm of its lamps; 20 W, 16 lm/W",
        "  intensity: type C, up to 100 cd; 1 horizontal × 3 vertical angles",
        "  luminous body: cylinder 0.2 × 0.2 × 0 m",
    ]


def test_diagrams_are_drawn(call, lamp, room):
    outcome = call("luminaire", "plot", lamp, "-o", "polar.png", "--plane", "30")
    assert outcome.status == 0
    assert (room / "polar.png").read_bytes()[:4] == b"\x89PNG"


def test_what_is_wrong_takes_one_line(call, lamp):
    for words in (
        ("info", "gone.ies"),
        ("info", "room.rad"),
        ("plot", lamp, "-o", "polar.gif"),
        ("plot", lamp, "-o", "a.png", *(["--plane", "1"] * 5)),
    ):
        outcome = call("luminaire", *words)
        assert outcome.status == 2
        assert outcome.err.count("\n") == 1
