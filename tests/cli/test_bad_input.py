"""Bad input: one line, exit status 2, nothing half-written."""

from pathlib import Path

import pytest

VIEW = "trace view --scene room.rad --window window.rad --sensors desk.pts -o V.mtx"
DAYLIGHT = "trace daylight --scene room.rad --window window.rad -o D.mtx"


def spoil(name, old, new):
    def change():
        path = Path(name)
        text = path.read_text()
        assert old in text
        path.write_text(text.replace(old, new, 1))

    return change


def write(name, text):
    return lambda: Path(name).write_text(text)


def nothing():
    pass


# Preparation, command, words of the one line on the error stream
BAD = {
    "missing study": (nothing, "run no.toml", "no.toml: cannot be read: No such file"),
    "study is a folder": (nothing, "run .", "cannot be read: Is a directory"),
    "wrong key in study": (
        spoil("study.toml", "seed", "sead"),
        "run study.toml",
        'study.toml:26: unknown key "trace.sead"',
    ),
    "damaged scene": (
        spoil("room.rad", "5 0.2 0.2 0.2 0 0", "5 0.2 0.2 dark 0 0"),
        "run study.toml",
        "room.rad:12: ",
    ),
    "truncated scene": (
        lambda: write("room.rad", Path("room.rad").read_text()[:-25])(),
        VIEW,
        "room.rad:",
    ),
    "missing scene": (nothing, VIEW.replace("room.rad", "no.rad"), "no.rad: cannot"),
    "unknown material type": (
        spoil("room.rad", "void plastic grey", "void unobtainium grey"),
        VIEW,
        "unobtainium",
    ),
    "missing window": (nothing, VIEW.replace("window.rad", "no.rad"), "no.rad: cannot"),
    "window without polygons": (write("window.rad", "# none\n"), VIEW, "no polygons"),
    "sensors of five numbers": (
        write("desk.pts", "1 1 1 0 0\n"),
        VIEW,
        "desk.pts:1: 5 numbers; six",
    ),
    "sensors with a word": (write("desk.pts", "1 1 1 0 0 up\n"), VIEW, '"up"'),
    "no sensors": (write("desk.pts", "# none\n"), VIEW, "desk.pts: no sensors"),
    "sensor NaN": (write("desk.pts", "nan 1 1 0 0 1\n"), VIEW, "desk.pts:1: "),
    "both goals": (
        nothing,
        f"{VIEW} --samples 64 --relative-error 0.1",
        "both samples and relative_error given; one of them expected",
    ),
    "error above one": (nothing, f"{VIEW} --relative-error 3", "relative_error is 3.0"),
    "no samples": (nothing, f"{VIEW} --samples 0", "--samples"),
    "half a sample": (nothing, f"{VIEW} --samples 0.5", "--samples"),
    "negative bounces": (nothing, f"{VIEW} --bounces -1", "--bounces"),
    "unknown device": (nothing, f"{VIEW} --device tpu", "tpu"),
    "unknown format": (nothing, f"{VIEW} --format text", "text"),
    "sky too fine": (nothing, f"{DAYLIGHT} --sky-subdivision 7", "--sky-subdivision"),
    "no output": (nothing, DAYLIGHT.replace(" -o D.mtx", ""), "--output"),
    "unknown option": (nothing, f"{DAYLIGHT} --fast", "--fast"),
    "unknown command": (nothing, "trace sums", "sums"),
    "no scene": (nothing, VIEW.replace("--scene room.rad", ""), "--scene"),
    "malformed BSDF": (
        write("diffuser.xml", "<WindowElement><Layer>"),
        "run study.toml",
        "diffuser.xml:",
    ),
    "not a BSDF": (write("diffuser.xml", "<a/>"), "bsdf info diffuser.xml", "diffuser"),
    "missing BSDF": (nothing, "bsdf info no.xml", "no.xml: cannot be read"),
    "weather of unknown format": (
        write("two_days.wea", "rain\n"),
        "run study.toml",
        "two_days.wea:1: unknown weather file format",
    ),
    "weather with a word": (
        spoil("two_days.wea", "6 20 5.500", "6 20 five"),
        "sky describe two_days.wea",
        "two_days.wea:12:",
    ),
    "truncated weather": (
        write("two_days.wea", "place X\nlatitude 51\n"),
        "sky matrix two_days.wea -o S.smx",
        "two_days.wea",
    ),
    "no sky and no sun": (
        nothing,
        "sky matrix two_days.wea -o S.smx --sun-only --no-direct",
        "both --sun-only and --no-direct",
    ),
    "sun of another size": (
        nothing,
        "sky matrix two_days.wea -o S.smx --sun-size 40",
        "diameter of the sun is 40",
    ),
    "one factor": (
        nothing,
        "multiply diffuser.xml -o E.mtx",
        "number of matrices in a product is 1; a number from 2 to 5",
    ),
    "six factors": (
        nothing,
        "multiply " + "diffuser.xml " * 6 + "-o E.mtx",
        "number of matrices in a product is 6; a number from 2 to 5",
    ),
    "sum without a second product": (
        nothing,
        "multiply diffuser.xml diffuser.xml + -o E.mtx",
        "number of matrices in a product is 0; a number from 2 to 5",
    ),
    "pictures in a sum": (
        nothing,
        "multiply V_%03d.hdr diffuser.xml + V_%03d.hdr diffuser.xml -o I_%03d.hdr",
        "set of pictures is a factor in a sum",
    ),
    "factor is no matrix": (
        nothing,
        "multiply diffuser.xml room.rad -o E.mtx",
        "room.rad",
    ),
    "results that are none": (nothing, "report .", "results.nc: cannot be read"),
    "negative seed": (nothing, "run study.toml --seed -1", "--seed"),
}


@pytest.mark.parametrize("case", BAD)
def test_bad_input_is_reported_in_one_line_and_writes_nothing(call, room, case):
    prepare, command, words = BAD[case]
    prepare()
    before = {path.name for path in room.iterdir()}
    outcome = call(*command.split())
    assert outcome.status == 2
    assert words in outcome.err
    assert outcome.err.count("\n") == 1
    assert outcome.out == ""
    left = {path for path in room.rglob("*") if path.name not in before}
    assert all(path.is_dir() and path.name == "study_results" for path in left)


def test_factors_that_do_not_fit_are_reported_with_their_files(call, room):
    Path("a.mtx").write_text("#?RADIANCE\nNROWS=1\nNCOLS=2\nNCOMP=1\n\n1 2\n")
    outcome = call("multiply", "a.mtx", "diffuser.xml", "-o", "E.mtx")
    assert outcome.status == 2
    assert "a.mtx has 2 unlabelled entries as columns, diffuser.xml has" in outcome.err
    assert not Path("E.mtx").exists()


def test_an_output_that_cannot_be_written_is_a_failure(call, room):
    command = "sky matrix two_days.wea --subdivision 1 -o no/S.smx"
    outcome = call(*command.split())
    assert outcome.status == 1
    assert "no/S.smx: cannot be written: No such file or directory" in outcome.err


def test_a_results_folder_that_is_a_file_is_a_failure(call, room):
    outcome = call("run", "study.toml", "--out", "room.rad")
    assert outcome.status == 1
    assert "room.rad: cannot be made: File exists" in outcome.err


def test_a_fault_of_our_own_is_one_line_too(call, monkeypatch):
    def broken(_path):
        raise ZeroDivisionError("division by zero")

    monkeypatch.setattr("clerestory.cli.bsdf.read_bsdf", broken)
    outcome = call("bsdf", "info", "diffuser.xml")
    assert outcome.status == 1
    assert outcome.err == (
        "unexpected ZeroDivisionError: division by zero;"
        " set CLERESTORY_TRACEBACK=1 for the traceback\n"
    )
    monkeypatch.setenv("CLERESTORY_TRACEBACK", "1")
    assert "Traceback" in call("bsdf", "info", "diffuser.xml").err


def test_an_interruption_is_one_line(call, monkeypatch):
    def interrupted(_path):
        raise KeyboardInterrupt

    monkeypatch.setattr("clerestory.cli.bsdf.read_bsdf", interrupted)
    outcome = call("bsdf", "info", "diffuser.xml")
    assert outcome.status == 130
    assert outcome.err == "interrupted; run again to resume\n"
