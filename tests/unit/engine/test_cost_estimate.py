"""Trials do what the run will do, and what jobs share is counted once."""

import time
from dataclasses import dataclass, field

import numpy as np
import pytest

from clerestory.directions import Frame
from clerestory.engine import cost_estimate
from clerestory.engine.cost_estimate import Plan, estimate_costs
from clerestory.engine.effort import Effort
from clerestory.engine.matrix_jobs import DaylightJob, ViewJob
from clerestory.engine.unscattered_jobs import UnscatteredJob
from clerestory.engine.work_units import Goal, Local
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.scene.model import Polygon, Scene
from clerestory.scene.sensors import Sensors
from clerestory.scene.window import Window

FRAME = Frame.from_normal_up(np.array([0.0, 1, 0]), np.array([0.0, 0, 1]))
PANE = Polygon(np.array([[0.0, 0, 0], [0, 0, 1], [1, 0, 1], [1, 0, 0]]), "", "")
WINDOW = Window("south", (PANE,), FRAME, klems("full"))
SENSORS = Sensors(np.zeros((1000, 3)), np.tile([0, 0, 1.0], (1000, 1)))
WALK = Effort(seed=1, device="cpu").job_options()

# Seconds of the clock to build a scene, to prepare a job, and for each million paths
SCENE, JOB, MILLION = 50.0, 2.0, 10.0


@dataclass
class Clockwork(Local):
    """Traces nothing, but moves the clock as if it did."""

    now: float = 0.0
    units: list = field(default_factory=list)
    job: object = None

    def map(self, job, units):
        for unit in units:
            self.units.append((job, unit))
            if job is not self.job:
                same = self.job is not None and job.scene is self.job.scene
                same &= type(job) is type(self.job)
                self.now += JOB + SCENE * (not same)
                self.job = job
            paths = len(unit.rows) * unit.count * job.batches
            self.now += MILLION * paths * 1e-6
            yield np.ones((len(unit.rows), *job.shape[1:]), np.uint64)


@pytest.fixture
def place(monkeypatch):
    clock = Clockwork()
    monkeypatch.setattr(time, "perf_counter", lambda: clock.now)
    return clock


def test_a_trial_takes_as_many_paths_a_row_as_the_run(place):
    """What each row costs besides is then part of the rate."""
    plan = Plan(place)
    job = ViewJob(scene=Scene(), windows=(WINDOW,) * 40, sensors=SENSORS, **WALK)
    plan.accepts(job, Goal(samples=512))
    [found] = estimate_costs(plan)
    for _, unit in place.units:
        assert unit.count == 32
        assert len(unit.rows) == cost_estimate._PILOT_BYTES // (16 * 40 * 145 * 8)
    assert found.paths == 512_000
    assert found.seconds == pytest.approx(SCENE + JOB + MILLION * 0.512)


@pytest.mark.parametrize("sensors", [1, 35, 1000])
def test_a_trial_of_the_sun_is_as_long_as_others(sensors):
    """A trial of few suns and sensors measures only the start of a kernel."""
    few = Sensors(SENSORS.position[:sensors], SENSORS.direction[:sensors])
    job = UnscatteredJob(
        scene=Scene(),
        sensors=few,
        directions=np.tile([0.0, -1, 0], (10_000, 64, 1)),
        samples=64,
        **WALK,
    )
    unit = job.pilot_unit(cost_estimate._PILOT_PATHS)
    paths = unit.paths(job.batches)
    assert 0.9 < paths / cost_estimate._PILOT_PATHS <= 1


def test_windows_of_a_scene_build_it_once(place):
    """Forty windows: one scene, forty times the little that is each window's own."""
    plan, scene, sky = Plan(place), Scene(), reinhart(1)
    for _ in range(40):
        plan.accepts(
            DaylightJob(scene=scene, window=WINDOW, sky=sky, **WALK), Goal(samples=160)
        )
    other = Scene()
    plan.accepts(
        DaylightJob(scene=other, window=WINDOW, sky=sky, **WALK), Goal(samples=160)
    )
    seconds = [each.seconds for each in estimate_costs(plan)]
    trace = MILLION * 145 * 160e-6
    np.testing.assert_allclose(seconds[0], SCENE + JOB + trace)
    np.testing.assert_allclose(seconds[1:40], JOB + trace)
    np.testing.assert_allclose(seconds[40], SCENE + JOB + trace)


def test_a_trial_of_few_paths_stays_as_it_is(place):
    """No more rows and points than there are."""
    plan = Plan(place)
    few = Sensors(SENSORS.position[:3], SENSORS.direction[:3])
    plan.accepts(
        ViewJob(scene=Scene(), windows=(WINDOW,), sensors=few, **WALK),
        Goal(samples=100),
    )
    [found] = estimate_costs(plan)
    assert found.paths == 3 * 7 * 16
    assert all(len(unit.rows) == 3 for _, unit in place.units)
