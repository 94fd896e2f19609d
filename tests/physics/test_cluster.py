"""The same bits from one process and from clusters, whatever happens to workers."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
from clusters import local_cluster
from physics_scenes import box

import clerestory as cl
from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.cluster import cluster as clusters
from clerestory.engine.work_units import Local, Unit, UnitSize
from clerestory.errors import DeviceError, InputError
from clerestory.hemisphere.klems import klems
from clerestory.scene.sensors import Sensors

ROOM = Path(__file__).parents[1] / "cli" / "room"
DESKS = np.stack([np.linspace(0.5, 3.5, 12), np.full(12, 2.0), np.full(12, 0.8)], 1)
SENSORS = Sensors(DESKS, np.tile([0, 0, 1.0], (12, 1)))


@pytest.fixture
def small_units(monkeypatch):
    """A trace of seconds has as many units as one of hours."""
    monkeypatch.setattr(clusters, "_UNIT_SIZE", UnitSize(paths=1 << 14, sums=1 << 20))


class WorkerKiller:
    """Progress callback that kills a worker when a fraction of the work is done."""

    def __init__(self, cluster, share=0.4):
        self.cluster, self.share, self.killed = cluster, share, False

    def __call__(self, share, note):
        if not self.killed and self.share < share < 0.9:
            self.cluster.kill(0)
            self.killed = True


def test_a_cluster_gives_the_same_bits_when_a_worker_is_killed(small_units, tmp_path):
    """Sums are whole numbers: a unit done twice, or elsewhere, adds the same."""
    scene, south = box(4, 5, 3, 0.6)
    options = {"sensors": SENSORS, "samples": 1 << 15, "seed": 3, "device": "cpu"}
    here = cl.view_matrix(scene, south, **options)
    with local_cluster(tmp_path, workers=2) as started:
        killer = WorkerKiller(started)
        with cl.Cluster(started.address) as cluster:
            there = cl.view_matrix(
                scene, south, executor=cluster, progress=killer, **options
            )
            assert killer.killed
            assert cluster.workers() == 1
    assert np.array_equal(here.values, there.values)
    assert np.array_equal(here.components, there.components)


@pytest.mark.slow
def test_work_goes_on_when_all_workers_were_lost(small_units, tmp_path):
    """The scene is sent again to whoever joins."""
    scene, south = box(4, 5, 3, 0.6)
    options = {"sensors": SENSORS, "samples": 1 << 14, "seed": 3, "device": "cpu"}
    here = cl.view_matrix(scene, south, **options)
    with (
        local_cluster(tmp_path, workers=1) as started,
        cl.Cluster(started.address) as cluster,
    ):

        def replace_worker(share, note):
            if share > 0.3 and len(started.workers) == 1:
                started.kill(0)
                started.add_worker()

        there = cl.view_matrix(
            scene, south, executor=cluster, progress=replace_worker, **options
        )
    assert len(started.workers) == 2
    assert np.array_equal(here.values, there.values)


def test_an_error_of_a_unit_is_that_of_one_process(tmp_path):
    """What fails on a worker fails here, in the same words."""
    with (
        local_cluster(tmp_path, workers=1) as started,
        cl.Cluster(started.address) as cluster,
        pytest.raises(DeviceError, match="no NVIDIA driver was found"),
    ):
        cluster.resolve("cuda")


def test_where_no_scheduler_answers_is_bad_input(monkeypatch):
    monkeypatch.setattr("clerestory.cluster.cluster._SCHEDULER", 1)
    with pytest.raises(InputError, match="no dask scheduler answers at"):
        cl.Cluster("tcp://127.0.0.1:9")


def test_a_unit_asks_for_nothing_but_its_job(device):
    """Done twice, after others or alone: the same sums."""
    from clerestory.engine.effort import Effort
    from clerestory.engine.matrix_jobs import ViewJob

    scene, south = box(4, 5, 3, 0.6)
    job = ViewJob(
        scene=scene, windows=(south,), sensors=SENSORS,
        **Effort(seed=5, device=device).job_options(),
    )  # fmt: skip
    units = [Unit(np.arange(r, r + 3), f, 64) for r in (0, 6) for f in (0, 128)]
    busy = Local()
    inorder = list(busy.map(job, units))
    for unit, sums in zip(reversed(units), reversed(inorder), strict=True):
        assert np.array_equal(Local().run(job, unit), sums)


def study_in(folder):
    """The ten-polygon room with a longer trace."""
    shutil.copytree(ROOM, folder)
    write_bsdf(folder / "diffuser.xml", lambertian(0.5, klems("quarter")))
    file = folder / "study.toml"
    text = file.read_text().replace("samples = 256", "samples = 8192")
    view = '[[view]]\nname = "seat"\nfile = "seat.vf"\nresolution = 24\nsamples = 64\n'
    file.write_text(f"{text}\n{view}")
    (folder / "seat.vf").write_text("rvu -vta -vp 2 2 1.2 -vd 0 -1 0 -vh 180 -vv 180\n")
    return cl.read_study(file)


@pytest.mark.slow
@pytest.mark.filterwarnings("ignore:.*too coarse to tell glare sources")
@pytest.mark.parametrize("workers", [2, 3])
def test_a_study_gives_the_same_files_on_a_cluster(small_units, tmp_path, workers):
    """Matrices byte by byte, results value by value, with one worker killed."""
    study = study_in(tmp_path / "room")
    here = cl.run_study(study, out=tmp_path / "here")
    with local_cluster(tmp_path, workers=workers) as started:
        killer = WorkerKiller(started, share=0.2)
        there = cl.run_study(
            study.with_trace(cluster=started.address),
            out=tmp_path / "there",
            display=lambda phase: killer if "daylight" in phase else lambda *_: None,
        )
        assert killer.killed
    files = sorted(path.name for path in (tmp_path / "here/matrices").iterdir())
    assert len(files) == 3
    for name in files:
        one, two = (tmp_path / side / "matrices" / name for side in ("here", "there"))
        assert one.read_bytes() == two.read_bytes()
    assert here.data.identical(there.data)
    facts = [
        json.loads((tmp_path / s / "run.json").read_text()) for s in ("here", "there")
    ]
    assert facts[0]["study"] == facts[1]["study"]
