"""Which device is taken, and how large its launches are: without any GPU."""

import ctypes

import pytest

from clerestory.engine import device as devices
from clerestory.engine import work_units
from clerestory.errors import ClerestoryWarning, DeviceError


class FakeDriver:
    """A CUDA driver that reports 20 GB of free memory, or fails at one call."""

    def __init__(self, failing=None):
        self.failing, self.calls = failing, []

    def __getattr__(self, name):
        def call(*arguments):
            self.calls.append(name)
            if name == self.failing:
                return 100
            if name == "cuMemGetInfo_v2":
                arguments[0]._obj.value, arguments[1]._obj.value = 20 << 30, 24 << 30
            return 0

        return call


@pytest.fixture
def driver(monkeypatch):
    """Put a driver in place of the machine's."""

    def install(failing=None):
        fake = FakeDriver(failing)
        monkeypatch.setattr(devices, "_cuda_driver", lambda: "cuda")
        monkeypatch.setattr(ctypes, "CDLL", lambda name: fake)
        return fake

    return install


def test_free_memory_is_that_of_the_driver(driver):
    fake = driver()
    assert devices.free_memory() == 20 << 30
    assert fake.calls[-1] == "cuDevicePrimaryCtxRelease_v2"


@pytest.mark.parametrize(
    "failing",
    ["cuInit", "cuDeviceGet", "cuDevicePrimaryCtxRetain", "cuCtxPushCurrent_v2",
     "cuMemGetInfo_v2"],
)  # fmt: skip
def test_free_memory_is_unknown_if_the_driver_fails(driver, failing):
    driver(failing)
    assert devices.free_memory() is None


def test_launches_on_a_gpu_fill_a_part_of_its_memory(monkeypatch):
    """A quarter for paths, a quarter for sums; never less than on a CPU."""
    local, cpu = work_units.Local(), work_units.Local().unit_size("cpu")
    monkeypatch.setattr(work_units, "free_memory", lambda: 8 << 30)
    unit_size = local.unit_size("cuda")
    assert unit_size.paths * work_units._PATH_BYTES == 2 << 30
    assert unit_size.sums == 2 << 30
    monkeypatch.setattr(work_units, "free_memory", lambda: 1 << 20)
    assert local.unit_size("cuda") == cpu
    monkeypatch.setattr(work_units, "free_memory", lambda: None)
    assert local.unit_size("cuda") == cpu


def test_a_gpu_that_fails_leaves_the_work_to_the_cpu_and_says_why(monkeypatch):
    monkeypatch.setattr(devices, "_cuda_driver", lambda: "cuda")
    monkeypatch.setattr(devices, "_probe", lambda variant, environment: "out of order")
    monkeypatch.setattr(devices, "_start_llvm", lambda: None)
    with pytest.warns(ClerestoryWarning, match=r"not used \(out of order\); the CPU"):
        assert devices.resolve.__wrapped__("auto") == "cpu"
    with pytest.raises(DeviceError, match="out of order"):
        devices.resolve.__wrapped__("cuda")


def test_a_machine_without_a_gpu_says_nothing(monkeypatch):
    monkeypatch.setattr(devices, "_cuda_driver", lambda: None)
    monkeypatch.setattr(devices, "_start_llvm", lambda: None)
    assert devices.resolve.__wrapped__("auto") == "cpu"
