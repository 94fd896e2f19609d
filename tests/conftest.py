"""Fixtures shared by all tests, and the choice of slow tests."""

from pathlib import Path

import pytest

import slow_share

REPOSITORY = Path(__file__).parents[1]


@pytest.fixture(scope="session")
def shared_data() -> Path:
    """Folder of reference data beside the repository; the test skips without it."""
    folder = REPOSITORY.parent / "shared" / "data"
    if not folder.is_dir():
        pytest.skip(f"reference data are not here: {folder} is missing")
    return folder


def pytest_addoption(parser):
    parser.addoption("--all", action="store_true", help="run the slow tests too")
    parser.addoption(
        "--mutants",
        type=int,
        default=100,
        help="number of damaged files that each reader is given",
    )
    parser.addoption(
        "--slow-minutes",
        type=float,
        default=0.0,
        help="run a share of the slow tests that takes about this long [min]",
    )
    parser.addoption(
        "--slow-choice",
        default="",
        help="text that chooses the share, such as the name of a commit",
    )
    parser.addoption(
        "--record-slow",
        action="store_true",
        help=f"keep what slow tests took in {slow_share.RECORD.name}",
    )


def pytest_configure(config):
    config.pluginmanager.register(slow_share.Durations(), "slow_durations")


def pytest_collection_modifyitems(config, items):
    slow = [item for item in items if item.get_closest_marker("slow")]
    known = slow_share.read_record()
    chosen = {item.nodeid for item in slow}
    if not config.getoption("--all"):
        chosen = slow_share.choose(
            chosen,
            seconds=60 * config.getoption("--slow-minutes"),
            choice=config.getoption("--slow-choice"),
            known=known,
        )
    config.slow_report = slow_share.describe(chosen, len(slow), known)
    if hasattr(config, "workeroutput"):
        config.workeroutput["slow_report"] = config.slow_report
    skip = pytest.mark.skip(reason="slow: not in this run's share; run with --all")
    for item in slow:
        if item.nodeid not in chosen:
            item.add_marker(skip)


def pytest_report_collectionfinish(config):
    return getattr(config, "slow_report", None)


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node):
    """Keep what a worker process said of the slow tests."""
    node.config.slow_report = getattr(node, "workeroutput", {}).get("slow_report")


def pytest_terminal_summary(terminalreporter, config):
    if config.getoption("numprocesses", None):
        terminalreporter.write_line(getattr(config, "slow_report", None) or "")
