"""Interruptions that Dr.Jit and Mitsuba convert to other errors."""

import signal

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


def test_an_error_after_a_signal_is_an_interruption(monkeypatch, capsys):
    """Mitsuba's errors of materials do not name `KeyboardInterrupt` as their cause."""

    def run(*_):
        try:
            signal.raise_signal(signal.SIGTERM)
        except KeyboardInterrupt:
            raise RuntimeError("failed to instantiate a plugin") from None

    monkeypatch.setattr("clerestory.cli.main._run", run)
    assert main(["run", "study.toml"]) == 128 + signal.SIGTERM
    assert capsys.readouterr().err == "interrupted; run again to resume\n"
