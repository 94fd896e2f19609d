"""The analytic room and its course through the year for the tests of the report."""

import importlib.util
from pathlib import Path

import pytest


def load(name):
    file = Path(__file__).with_name(f"{name}.py")
    spec = importlib.util.spec_from_file_location(name, file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


@pytest.fixture(scope="session")
def room():
    """Module that makes results in closed form."""
    return load("analytic_room")


@pytest.fixture(scope="session")
def course():
    """Module that adds states, glare, terms and pictures in closed form."""
    return load("course")


@pytest.fixture(scope="session")
def standard_pages():
    """Module that adds verdicts of standards whose maps are known."""
    return load("standard_pages")
