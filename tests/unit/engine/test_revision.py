"""A matrix is used again only if the same estimators would trace it."""

import ast
import importlib.util
from pathlib import Path

import numpy as np
import pytest

from clerestory.engine.revision import ESTIMATOR_DIGEST
from clerestory.matrix.axis import unknown_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases import fingerprint
from clerestory.phases.matrix_store import MatrixStore

SCRIPT = Path(__file__).parents[3] / "scripts/record_revision.py"


@pytest.fixture(scope="module")
def script():
    spec = importlib.util.spec_from_file_location("record_revision", SCRIPT)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_the_revision_is_that_of_the_sources(script):
    assert script.digest() == ESTIMATOR_DIGEST, (
        "the code that traced matrices depend on has changed since it was recorded:"
        " stored matrices must not be used any more. Run scripts/record_revision.py,"
        " which raises engine/revision.py, and commit that file with the change"
    )


def test_comments_docstrings_and_layout_do_not_count(script):
    one = 'def f(x):\n    """Twice."""\n    # why\n    return 2 * x\n'
    other = "def f( x ):\n    return (2*x)\n"
    assert script.normal(ast.parse(one)) == script.normal(ast.parse(other))
    changed = other.replace("2", "3")
    assert script.normal(ast.parse(one)) != script.normal(ast.parse(changed))


def test_a_matrix_of_another_revision_is_traced_again(tmp_path, monkeypatch):
    store, traced = MatrixStore(tmp_path), []

    def make():
        traced.append(1)
        axis = unknown_axis(1)
        return TransferMatrix(np.ones((1, 1, 1)), axis, axis)

    def use():
        store.matrix("view", fingerprint.fingerprint("view", "scene"), make)

    use()
    use()
    assert len(traced) == 1
    revision = fingerprint.ESTIMATOR_REVISION
    monkeypatch.setattr(fingerprint, "ESTIMATOR_REVISION", revision + 1)
    use()
    assert len(traced) == 2
