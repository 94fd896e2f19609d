"""Shapes in annotations are checked at every call of the test run."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from jaxtyping import Float, TypeCheckError, jaxtyped

import clerestory
from array_shapes import check
from clerestory.directions import unit

ROOT = Path(clerestory.__file__).parent


def test_every_package_but_the_engine_is_checked(request):
    listed = request.config.getoption("--jaxtyping-packages").split(",")[:-1]
    modules = {f.relative_to(ROOT).parts[0] for f in ROOT.rglob("*.py")}
    packages = {module.removesuffix(".py") for module in modules}
    checked = packages - {"__init__", "engine", "demo"}
    assert set(listed) == {f"clerestory.{name}" for name in checked}


def test_a_wrong_shape_is_refused_at_the_call():
    with pytest.raises(TypeCheckError, match=r"batch 3"):
        unit(np.ones((3, 2)))


def test_other_types_are_left_to_mypy():
    @jaxtyped(typechecker=check)
    def scaled(value: Float[np.ndarray, " n"], *, factor: int) -> None: ...

    scaled(np.ones(3), factor="two")
    with pytest.raises(TypeCheckError):
        scaled(np.ones((3, 3)), factor=2)


def test_own_checks_of_values_come_before_the_shape_check():
    @jaxtyped(typechecker=check)
    @dataclass(frozen=True, eq=False)
    class Row:
        value: Float[np.ndarray, " n"]
        strict: bool

        def __post_init__(self):
            if self.strict and self.value.ndim != 1:
                raise ValueError("one row expected")

    with pytest.raises(ValueError, match="one row"):
        Row(np.ones((2, 2)), strict=True)
    with pytest.raises(TypeCheckError):
        Row(np.ones((2, 2)), strict=False)
