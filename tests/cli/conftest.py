"""The ten-polygon room, and the command line called in this process."""

import shutil
from dataclasses import dataclass
from pathlib import Path

import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.cli.main import main
from clerestory.hemisphere.klems import klems


@pytest.fixture
def room(tmp_path, monkeypatch):
    """The current folder holds the room, and may be spoilt."""
    folder = tmp_path / "room"
    shutil.copytree(Path(__file__).parent / "room", folder)
    write_bsdf(folder / "diffuser.xml", lambertian(0.5, klems("quarter")))
    monkeypatch.chdir(folder)
    return folder


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    status: int
    out: str
    err: str


@pytest.fixture
def call(capsys, room):
    """Call the program as from a shell in the room's folder."""

    def run(*words):
        capsys.readouterr()
        status = main([str(word) for word in words])
        captured = capsys.readouterr()
        return Outcome(status, captured.out, captured.err)

    return run
