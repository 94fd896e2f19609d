"""`--cluster` where there is none: one line that says what was expected."""

import sys

import pytest

import clerestory as cl
from clerestory.cluster import cluster

NOWHERE = "tcp://127.0.0.1:9"
VIEW = ("trace", "view", "--scene", "room.rad", "--window", "window.rad")


@pytest.fixture(autouse=True)
def hurried(monkeypatch):
    monkeypatch.setattr(cluster, "_SCHEDULER", 1)


@pytest.mark.parametrize(
    "words",
    [
        (*VIEW, "--sensors", "desk.pts", "-o", "V.mtx"),
        ("run", "study.toml", "--out", "results"),
        ("run", "study.toml", "--out", "results", "--plan"),
    ],
)
def test_an_address_where_nothing_answers_is_bad_input(call, words):
    done = call(*words, "--cluster", NOWHERE)
    assert done.status == 2
    line = f"no dask scheduler answers at '{NOWHERE}'; an address such as"
    assert done.err.startswith(line)
    assert done.err.count("\n") == 1


TRACING = ("run", "render", "illum", "trace view", "trace daylight", "trace facade")


@pytest.mark.parametrize("command", [*TRACING, "trace coefficients", "trace sun"])
def test_every_command_that_traces_scenes_can_have_others_do_it(call, command):
    assert "--cluster" in call(*command.split(), "--help").out


def test_without_dask_the_extra_is_named(call, monkeypatch):
    monkeypatch.setitem(sys.modules, "distributed", None)
    done = call("run", "study.toml", "--out", "results", "--cluster", NOWHERE)
    assert done.status == 1
    assert "pip install 'clerestory[cluster]'" in done.err


def test_results_do_not_depend_on_the_cluster_of_the_study_file(room):
    """Where the work was done changes nothing, so it is no part of the results."""
    text = (room / "study.toml").read_text()
    named = text.replace("[trace]", f'[trace]\ncluster = "{NOWHERE}"')
    (room / "study.toml").write_text(named)
    study = cl.read_study("study.toml")
    assert study.trace.cluster == NOWHERE
    assert "cluster" not in study.facts()["trace"]
    assert study.with_trace(cluster="tcp://elsewhere:1").trace.cluster != NOWHERE
