"""Two runs with one output, and runs that are stopped, as a shell starts them."""

import importlib
import os
import platform
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from clerestory.errors import OutputError
from clerestory.file_lock import locked

PROGRAM = [sys.executable, "-c", "from clerestory.cli.main import main; exit(main())"]
HOLD = (
    "import sys, time; from clerestory.file_lock import locked\n"
    "with locked(sys.argv[1]):\n  print(flush=True); time.sleep(600)\n"
)
LONG = "run study.toml --quiet --out"


def listen():
    """Reset what a test run in the background, or under nohup, has ignored."""
    for number in (signal.SIGINT, signal.SIGHUP, signal.SIGTERM):
        signal.signal(number, signal.SIG_DFL)


@pytest.fixture
def started():
    """Start programs that end with the test."""
    running = []

    def start(*words, program=PROGRAM, **more):
        child = subprocess.Popen(
            [*program, *words],
            stderr=subprocess.PIPE,
            text=True,
            preexec_fn=listen,
            **more,
        )
        running.append(child)
        return child

    yield start
    for child in running:
        child.kill()
        child.communicate()


@pytest.fixture
def long_study(room):
    """A study whose first matrix takes seconds, and its second five times as long."""
    text = Path("study.toml").read_text()
    Path("study.toml").write_text(text.replace("samples = 256", "samples = 500000"))


def wait_for(condition, *, seconds=60):
    until = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < until, "waited too long"
        time.sleep(0.02)


def test_a_second_run_into_a_folder_is_refused_at_once(call, started, long_study):
    """Its line names process, machine and time; after SIGKILL the folder is free."""
    importlib.import_module("clerestory.cli.study")  # may take as long as the study
    child = started(*LONG.split(), "results")
    wait_for(Path("results/run.lock").exists)
    outcome = call(*LONG.split(), "results")
    assert child.poll() is None
    assert outcome.status == 1
    assert outcome.err.startswith("results: another run writes here (process ")
    assert outcome.err.count("\n") == 1
    assert f"process {child.pid} on {platform.node()}, 2" in outcome.err
    child.kill()
    child.wait()
    assert Path("results/run.lock").exists()
    text = Path("study.toml").read_text()
    Path("study.toml").write_text(text.replace("samples = 500000", "samples = 16"))
    assert call(*LONG.split(), "results").status == 0
    assert not Path("results/run.lock").exists()


def test_a_second_run_to_a_file_is_refused_at_once(call, room):
    holder = [sys.executable, "-c", HOLD, "S.smx"]
    with subprocess.Popen(holder, stdout=subprocess.PIPE, cwd=room) as child:
        child.stdout.readline()
        command = "sky matrix two_days.wea --subdivision 1 -o S.smx"
        outcome = call(*command.split())
        assert outcome.status == 1
        assert f"S.smx: another run writes here (process {child.pid}" in outcome.err
        assert not Path("S.smx").exists()
        child.kill()
    assert call(*command.split()).status == 0
    assert not Path("S.smx.lock").exists()


def test_threads_of_one_program_count_as_two_runs(tmp_path):
    again = pytest.raises(OutputError, match="another run")
    with locked(tmp_path / "a"), again, locked(tmp_path / "a"):
        pass
    with locked(tmp_path / "a"), locked(tmp_path / "b"):
        pass


def test_a_lock_file_of_another_program_is_left_alone(tmp_path):
    for make in (lambda p: p.write_text("poetry"), os.mkfifo, Path.mkdir):
        path = tmp_path / "a.lock"
        make(path)
        with pytest.raises(OutputError, match=r"a\.lock"), locked(tmp_path / "a"):
            pass
        path.rmdir() if path.is_dir() else path.unlink()
    target = tmp_path / "precious"
    target.write_text("process 1")
    (tmp_path / "a.lock").symlink_to(target)
    with pytest.raises(OutputError, match="symbolic"), locked(tmp_path / "a"):
        pass
    assert target.read_text() == "process 1"


def test_many_runs_at_once_hold_a_lock_one_after_the_other(tmp_path):
    """Locks that are deleted while others open them: never two holders."""
    script = (
        "import sys, os\n"
        "from clerestory.file_lock import locked\n"
        "from clerestory.errors import OutputError\n"
        "done = 0\n"
        "while done < 200:\n"
        "  try:\n"
        "    with locked('out'):\n"
        "      os.mkdir('inside'); os.rmdir('inside'); done += 1\n"
        "  except OutputError as error:\n"
        "    assert 'another run' in str(error), error\n"
    )
    words = [sys.executable, "-c", script]
    children = [subprocess.Popen(words, cwd=tmp_path) for _ in range(3)]
    assert [child.wait(60) for child in children] == [0, 0, 0]


@pytest.mark.parametrize(
    "stop",
    [
        signal.SIGTERM,
        pytest.param(signal.SIGHUP, marks=pytest.mark.slow),
        pytest.param(signal.SIGINT, marks=pytest.mark.slow),
    ],
)
def test_a_stopped_run_ends_in_order(started, long_study, stop):
    child = started(*LONG.split(), "results")
    wait_for(lambda: any(Path("results").glob("matrices/*.nc")))
    child.send_signal(stop)
    _, said = child.communicate(timeout=60)
    assert child.returncode == 128 + stop
    assert said.splitlines()[-1] == "interrupted; run again to resume"
    # What was traced is stored; neither lock nor temporary file is left
    left = {path.name for path in Path("results").rglob("*") if path.is_file()}
    assert left
    assert all(name.endswith(".nc") and not name.startswith(".") for name in left)


def test_a_closed_terminal_does_not_stop_a_run_under_nohup():
    script = (
        "import os, signal\n"
        "from clerestory.cli.interruption import interruptible\n"
        "signal.signal(signal.SIGHUP, signal.SIG_IGN)\n"
        "with interruptible():\n"
        "  os.kill(os.getpid(), signal.SIGHUP)\n"
    )
    subprocess.run([sys.executable, "-c", script], check=True)


WORK = """
import os, sys, time
from pathlib import Path
from clerestory.cli.interruption import interruptible
from clerestory.gonio.parallel import Workers

def slow(number):
    Path(str(os.getpid())).touch()
    time.sleep(0.2)
    return number

if __name__ == "__main__":
    with interruptible() as received:
        try:
            Workers(2).map("numbers", slow, [(n,) for n in range(10000)])
        except KeyboardInterrupt:
            sys.exit(received.status())
"""


@pytest.mark.parametrize("stop", [signal.SIGTERM, signal.SIGKILL])
def test_worker_processes_end_with_their_run(tmp_path, stop):
    (tmp_path / "work.py").write_text(WORK)
    child = subprocess.Popen([sys.executable, "work.py"], cwd=tmp_path)

    def workers():
        return [path for path in tmp_path.iterdir() if path.name.isdigit()]

    wait_for(lambda: len(workers()) == 2)
    child.send_signal(stop)
    assert child.wait(20) == (143 if stop == signal.SIGTERM else -stop)
    wait_for(lambda: not any(Path("/proc", w.name).exists() for w in workers()))
