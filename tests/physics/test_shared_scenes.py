"""A scene is built once for all that is traced in it, and no result can tell."""

import numpy as np
import pytest
from physics_scenes import box, quad, window

import clerestory as cl
from clerestory.engine.origin import middle_of_scene, window_origin
from clerestory.engine.scene_cache import SceneCache, cached
from clerestory.engine.work_units import Local
from clerestory.scene.model import Scene

GOAL = {"samples": 64, "subdivision": 1}


@pytest.fixture
def built(monkeypatch, device):
    """Scenes in the order in which they are built on the device."""
    from clerestory.engine import lower

    scenes, real = [], lower._lowered

    def counts(scene, origin, receivers):
        scenes.append((scene, len(receivers)))
        return real(scene, origin, receivers)

    monkeypatch.setattr(lower, "_lowered", counts)
    return scenes


def room():
    """A room with a window on the south, and one on the north."""
    scene, south = box(4, 5, 3, 0.6)
    north = window(quad((3, 4.9, 1), (3, 4.9, 2), (1, 4.9, 2), (1, 4.9, 1)))
    return scene, [south, cl.Window("north", north.polygons, north.frame,
                                    north.partition)]  # fmt: skip


def test_all_windows_share_a_scene_and_have_the_light_of_each_alone(built, device):
    """To the bit: a window's matrix depends on its scene, itself and its seed."""
    scene, windows = room()
    together = cl.daylight_matrices(scene, windows, seed=3, device=device, **GOAL)
    assert built == [(scene, 0)]
    for number, each in enumerate(windows):
        alone = cl.daylight_matrix(scene, each, seed=3 + number, device=device, **GOAL)
        assert np.array_equal(together[each.name].values, alone.values)
        assert np.array_equal(together[each.name].components, alone.components)
    assert built == 3 * [(scene, 0)]


def test_scenes_that_the_next_job_does_not_use_are_released(built, device):
    """Views have windows in their scene, another scene is another one."""
    scene, windows = room()
    sensors = cl.Sensors(np.array([[2, 2, 0.8]]), np.array([[0, 0, 1.0]]))
    place = Local()
    options = {"executor": place, "device": device}
    cl.daylight_matrices(scene, windows, **options, **GOAL)
    for _ in range(2):
        cl.view_matrices(scene, windows, sensors=sensors, samples=64, **options)
        assert len(place._cache._kept) == 1
    other = Scene(scene.materials, scene.surfaces)
    cl.daylight_matrices(other, windows, **options, **GOAL)
    assert built == [(scene, 0), (scene, 2), (other, 0)]
    assert len(place._cache._kept) == 1


def test_the_former_is_gone_before_the_next_is_built():
    """Two halls of millions of triangles need not fit into memory."""
    cache, held = SceneCache(), []

    def build():
        held.append(len(cache._kept))
        return object()

    for names in (("a", "b"), ("b", "c"), ("d",)):
        with cache.preparing():
            for name in names:
                cached((name,), build)
    # a; b beside it; c beside b, when a is gone; d alone
    assert held == [0, 1, 1, 0]
    assert cached(("d",), lambda: "new") == "new"  # without a cache


def test_windows_near_the_middle_of_a_scene_share_its_origin():
    """Far ones have their own, where numbers are finer."""
    scene, windows = room()
    far = 500.0
    ground = quad((-far, -far, 0), (far, -far, 0), (far, far, 0), (-far, far, 0))
    wide = Scene(scene.materials, (*scene.surfaces, ground))
    np.testing.assert_allclose(middle_of_scene(wide), [2, 2.5, 1.5], atol=2)
    one, other = (window_origin(wide, each) for each in windows)
    assert np.array_equal(one, other)
    away = quad((300, 0, 0), (300, 0, 2), (302, 0, 2), (302, 0, 0))
    assert window_origin(wide, window(away)).tolist() == [301, 0, 1]
    assert middle_of_scene(Scene()).tolist() == [0, 0, 0]
