"""Public values are shown in one line, however large their arrays."""

import dataclasses
import inspect
import typing

import numpy as np
import pytest

import clerestory
from clerestory.brief_repr import brief
from clerestory.bsdf.analytic import lambertian
from clerestory.glazing.layer import Diffuser
from clerestory.glazing.pane import grey_pane
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sensor_axis, sky_axis
from clerestory.scene.material import Material
from clerestory.scene.model import Plastic, Polygon, Scene, TriangleMesh
from clerestory.sky.weather import Weather
from clerestory.study.results import Results

COUNT = 500


def many_polygons():
    corner = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0]])
    return tuple(Polygon(corner + n, "wall", f"p{n}") for n in range(COUNT))


def weather():
    hours = np.arange(8760)
    times = np.datetime64("2023-01-01T00:30", "s") + hours * np.timedelta64(1, "h")
    light = 1.0 * hours
    return Weather("x" * 300, 50.0, 8.0, 0.0, 1.0, times, 60.0, light, light, light)


VALUES = {
    "bsdf": lambda: lambertian(0.5, klems("full")),
    "tree": lambda: (
        lambertian(0.5, klems("full")).tabulated().scattering("reflection_back")
    ),
    "scene": lambda: Scene({"wall": Plastic("wall", np.ones(3))}, many_polygons()),
    "mesh": lambda: TriangleMesh(np.ones((9999, 3)), np.zeros((9, 3), int), "wall"),
    "sensors": lambda: clerestory.Sensors(
        np.ones((COUNT, 3)), np.ones((COUNT, 3)), tuple(map(str, range(COUNT)))
    ),
    "matrix": lambda: clerestory.TransferMatrix(
        np.ones((3, COUNT, 146)),
        sensor_axis(COUNT, tuple(map(str, range(COUNT)))),
        sky_axis(reinhart(1)),
        np.ones((16, 3, COUNT, 146)),
    ),
    "axis": lambda: sensor_axis(COUNT, tuple(map(str, range(COUNT)))),
    "weather": weather,
    "sky": lambda: clerestory.sky_matrix(weather(), subdivision=1),
    "picture": lambda: clerestory.Picture(
        np.ones((90, 90, 3), np.float32), header=("VIEW= " + 900 * "x",) * 90
    ),
    "schedule": lambda: clerestory.StateSchedule(
        weather().times, {f"w{n}": np.zeros(8760, int) for n in range(99)}
    ),
    "partition": lambda: klems("full"),
    "sky partition": lambda: reinhart(6),
    "stack": lambda: clerestory.stack_layers([Diffuser(grey_pane(0.5, 0.2))]),
}


@pytest.mark.filterwarnings("ignore::clerestory.errors.ClerestoryWarning")
@pytest.mark.parametrize("value", VALUES)
def test_a_large_value_is_one_line(value):
    text = repr(VALUES[value]())
    assert "\n" not in text
    assert len(text) < 600


def test_results_are_one_line():
    xr = pytest.importorskip("xarray")
    data = xr.Dataset({"lux": (("sensor", "time"), np.ones((9, 8760)))})
    text = repr(Results(data, {"warnings": ["x" * 999] * 99}))
    assert (len(text) < 200, "\n" in text) == (True, False)


def test_arrays_are_shown_by_type_and_shape():
    assert repr(clerestory.Sensors(np.zeros((7, 3)), np.ones((7, 3)))) == (
        "Sensors(position=<float64 7 × 3>, direction=<float64 7 × 3>)"
    )


def classes_in(annotation):
    """Dataclasses in a type annotation."""
    if inspect.isclass(annotation) and dataclasses.is_dataclass(annotation):
        yield annotation
    for part in typing.get_args(annotation):
        yield from classes_in(part)


def public_values():
    """Public dataclasses, and those that public functions take and return."""
    for name in clerestory.__all__:
        item = getattr(clerestory, name)
        yield from classes_in(item)
        if inspect.isfunction(item):
            try:
                hints = typing.get_type_hints(item)
            except NameError:  # xarray is imported for the type checker only
                continue
            for hint in hints.values():
                yield from classes_in(hint)


def holds_arrays(annotation):
    """Whether values of a type can be large."""
    if dataclasses.is_dataclass(annotation):
        return any(holds_arrays(f.type) for f in dataclasses.fields(annotation))
    return any(word in str(annotation) for word in ("ndarray", "Mapping", "tuple["))


def test_every_public_value_with_arrays_is_brief():
    large = [kind for kind in set(public_values()) if holds_arrays(kind)]
    assert len(large) > 15
    for kind in large:
        if not issubclass(kind, Material):
            assert kind.__repr__ is brief, f"{kind.__module__}.{kind.__name__}"
