"""The analytic room for the tests of the report."""

import importlib.util
from pathlib import Path

import pytest


@pytest.fixture(scope="session")
def room():
    """Module that makes results in closed form."""
    file = Path(__file__).with_name("analytic_room.py")
    spec = importlib.util.spec_from_file_location("analytic_room", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module
