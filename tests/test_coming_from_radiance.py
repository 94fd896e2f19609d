"""Every line of the page for people who come from Radiance runs as it stands."""

import pytest

from clerestory.cli.main import main
from clerestory.study.new_study import write_demo
from test_docs import REPOSITORY, blocks, shell_commands

PAGE = REPOSITORY / "docs" / "coming-from-radiance.md"

PROGRAMS = """
    genBSDF rfluxmtx rcontrib dctimestep gendaymtx gendaylit genskyvec evalglare
    pabopto2bsdf bsdf2klems bsdf2ttree pkgBSDF mkillum rpict rtrace rmtxop pcomb pfilt
    falsecolor pcond ies2rad xform obj2rad genblinds wrapBSDF bsdfview dcglare oconv
    vwrays rttree_reduce checkBSDF hdrgen epw2wea gensky
"""

# Commands on the results of a whole study, which takes longer than all others
STUDY = {"run", "metrics", "report"}


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The demo, and the files that the page makes."""
    write_demo(tmp_path)
    monkeypatch.chdir(tmp_path)
    exec(next(blocks(PAGE)), {"__name__": "__main__"})
    return tmp_path


def failed(commands):
    return [" ".join(words) for words in commands if main(words) != 0]


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::clerestory.ClerestoryWarning")
def test_each_line_runs(folder, capsys):
    commands = [w for w in shell_commands(PAGE) if w[0] not in STUDY]
    assert len(commands) > 25
    assert not failed(commands), capsys.readouterr().err


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore::clerestory.ClerestoryWarning")
def test_the_study_runs_and_is_reported(folder, capsys):
    commands = [w for w in shell_commands(PAGE) if w[0] in STUDY]
    assert len(commands) == 3
    assert not failed(commands), capsys.readouterr().err


def test_each_program_of_radiance_has_a_line():
    """Those that the issue names, and the rest of the matrix methods' tool box."""
    text = PAGE.read_text(encoding="utf-8")
    missing = [program for program in PROGRAMS.split() if f"`{program}`" not in text]
    assert not missing
