"""Kernels are compiled once for tasks of every size."""

import numpy as np
import pytest
from physics_scenes import box

import clerestory as cl
from clerestory.engine.device import resolve
from clerestory.phases.rendering import irradiance
from clerestory.scene.model import DistantSource, Glass, Light, Plastic, Polygon, Scene
from clerestory.scene.sensors import Sensors

# Kernels of fewer operations compile in milliseconds.
SMALL = 100

VIEWS = (
    "-vtv -vp 1 3 1.5 -vd 0.2 -1 0 -vu 0 0 1 -vh 60 -vv 40",
    "-vtv -vp 2 3.5 1.2 -vd 0 -1 -0.1 -vu 0 0 1 -vh 50 -vv 50",
)


def kernels(device, task, size):
    """Return the names of the larger kernels that a task launches."""
    resolve(device)
    import drjit as dr

    dr.kernel_history_clear()
    with dr.scoped_set_flag(dr.JitFlag.KernelHistory, True):
        task(device, size)
        launches = dr.kernel_history([dr.KernelType.JIT])
    return {k["hash"] for k in launches if k["operation_count"] > SMALL}


def lit_room(azimuth_deg):
    """A room behind a pane of glass, under an even sky and a sun."""
    room, south = box(4, 5, 3, 0.5)
    azimuth = np.radians(azimuth_deg)
    sun = np.array([np.sin(azimuth), np.cos(azimuth), 0.6]) / np.hypot(1, 0.6)
    materials = {
        "wall": Plastic("wall", np.full(3, 0.5)),
        "glass": Glass("glass", np.full(3, 0.8), 1.52),
        "even": Light("even", np.ones(3)),
        "bright": Light("bright", np.full(3, 1e5)),
    }
    pane = Polygon(south.polygons[0].vertices, "glass", "pane")
    distant = (
        DistantSource(np.array([0.0, 0.0, 1.0]), 180.0, "even", "sky"),
        DistantSource(sun, 0.533, "bright", "sun"),
    )
    return Scene(materials, (*room.surfaces, pane), distant=distant)


def sensors(count):
    """Sensors along the middle of the room, looking up."""
    position = np.column_stack(
        [np.full(count, 2.0), np.linspace(1, 4, count), np.full(count, 0.8)]
    )
    return Sensors(position, np.tile([0.0, 0.0, 1.0], (count, 1)))


def draw_picture(device, size):
    """Another view, sun, resolution and effort."""
    cl.render(
        lit_room((170, 190)[size]), cl.parse_view(VIEWS[size]), columns=16 + 8 * size,
        rows=12 + 4 * size, samples=8 << size, bounces=2, device=device,
    )  # fmt: skip


def gather_irradiance(device, size):
    """Other sensors, another sun and effort."""
    irradiance(
        lit_room((170, 190)[size]), sensors(3 + size), samples=64 << size,
        bounces=2 + size, device=device,
    )  # fmt: skip


def trace_view(device, size):
    """Other sensors and effort."""
    scene, south = box(4, 5, 3, 0.5)
    cl.view_matrix(
        scene, south, sensors=sensors(3 + size), samples=64 << size, device=device
    )


def trace_daylight(device, size):
    """Another effort."""
    scene, south = box(4, 5, 3, 0.5)
    cl.daylight_matrix(scene, south, subdivision=1, samples=64 << size, device=device)


TASKS = (draw_picture, gather_irradiance, trace_view, trace_daylight)


@pytest.mark.parametrize("task", TASKS, ids=lambda task: task.__name__)
def test_a_task_of_another_size_compiles_nothing(device, task):
    """Compiling takes seconds, more than many a task itself."""
    assert kernels(device, task, 1) <= kernels(device, task, 0)
