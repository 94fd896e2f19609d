"""Interruptions while Dr.Jit records a kernel."""

import pytest

from clerestory.cli.main import main
from clerestory.engine.device import load


def interrupt(_):
    raise KeyboardInterrupt


def looped():
    import drjit as dr
    import mitsuba as mi

    dr.while_loop((mi.UInt32(0),), lambda number: number < 3, interrupt)


@pytest.fixture(autouse=True)
def loaded():
    load("cpu")


def test_a_loop_that_is_interrupted_raises_keyboard_interrupt():
    from clerestory.engine.upload import launching

    with pytest.raises(KeyboardInterrupt), launching():
        looped()


def test_a_command_that_is_interrupted_in_a_loop_says_so(monkeypatch, capsys):
    def run(*_):
        looped()

    monkeypatch.setattr("clerestory.cli.main._run", run)
    assert main(["run", "study.toml"]) == 130
    assert capsys.readouterr().err == "interrupted; run again to resume\n"
