"""Choice of the compute device, and of the LLVM library for the CPU.

Dr.Jit compiles its kernels with an LLVM library loaded at run time. Dr.Jit rejects some
versions of LLVM; others *abort the process* during compilation (Debian's LLVM 15). A
library not installed with this package is therefore tested in a child process before
Mitsuba is imported.
"""

import ctypes
import ctypes.util
import importlib
import importlib.metadata
import os
import platform
import subprocess
import sys
import warnings
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from types import ModuleType
from typing import Literal, get_args

from clerestory.errors import ClerestoryWarning, DeviceError, InputError

# Values of the setting `device`, and the actual devices
Device = Literal["auto", "cpu", "cuda"]
Processor = Literal["cpu", "cuda"]

_VARIANT = {"cpu": "llvm_ad_rgb", "cuda": "cuda_ad_rgb"}
_LIBRARY = "DRJIT_LIBLLVM_PATH"

_ADVICE = {
    "Linux": "pip install karellen-llvm-core (x86-64), or conda install llvmdev",
    "Darwin": "brew install llvm",
    "Windows": "the installer of https://github.com/llvm/llvm-project/releases",
}


@dataclass(frozen=True)
class Finding:
    """One line of the report of `clerestory doctor`."""

    name: str
    value: str
    good: bool


def load(device: Device = "auto", module: str = "controller") -> ModuleType:
    """Start the compute device, import a module of this package, and return it."""
    chosen = resolve(device)
    mitsuba = importlib.import_module("mitsuba")
    if mitsuba.variant() != _VARIANT[chosen]:
        mitsuba.set_variant(_VARIANT[chosen])
    return importlib.import_module(f"clerestory.engine.{module}")


@cache
def resolve(device: Device) -> Processor:
    """Return the compute device for a setting; "auto" selects a GPU if one works."""
    if device not in get_args(Device):
        raise InputError(f"unknown device {device!r}; one of auto, cpu, cuda expected")
    if device in ("auto", "cuda") and _cuda_driver() is not None:
        error = _probe(_VARIANT["cuda"], {})
        if error is None:
            return "cuda"
        if device == "cuda":
            raise DeviceError(f"the NVIDIA GPU fails ({error}); use --device cpu")
        warnings.warn(
            f"the NVIDIA GPU is not used ({error}); the CPU traces instead",
            ClerestoryWarning,
            stacklevel=2,
        )
    elif device == "cuda":
        raise DeviceError("no NVIDIA driver was found; use --device cpu")
    _start_llvm()
    return "cpu"


def limit_threads(count: int | None) -> None:
    """Set the number of threads of Dr.Jit, unless `count` is None."""
    if count is not None:
        resolve("auto")
        importlib.import_module("drjit").set_thread_count(count)


def free_memory() -> int | None:
    """Return the free memory of the GPU [bytes]; None if unknown.

    The CUDA driver is queried directly, since Dr.Jit reports only its own allocations.
    """
    name = _cuda_driver()
    if name is None:
        return None
    driver = ctypes.CDLL(name)
    context, device = ctypes.c_void_p(), ctypes.c_int()
    free, total = ctypes.c_size_t(), ctypes.c_size_t()
    if driver.cuInit(0) or driver.cuDeviceGet(ctypes.byref(device), 0):
        return None
    if driver.cuDevicePrimaryCtxRetain(ctypes.byref(context), device):
        return None
    try:
        if driver.cuCtxPushCurrent_v2(context):
            return None
        failed = driver.cuMemGetInfo_v2(ctypes.byref(free), ctypes.byref(total))
        driver.cuCtxPopCurrent_v2(ctypes.byref(context))
        return None if failed else free.value
    finally:
        driver.cuDevicePrimaryCtxRelease_v2(device)


def _start_llvm() -> None:
    # Set Dr.Jit's LLVM library to the bundled one, or to one tested in a child process
    if os.environ.get(_LIBRARY):
        library = os.environ[_LIBRARY]
    elif "drjit" in sys.modules:
        # Dr.Jit is imported and has already chosen a library: test that library
        error = _probe(_VARIANT["cpu"], {})
        if error is not None:
            raise DeviceError(
                f"Dr.Jit, imported first, uses an LLVM library that fails ({error});"
                f" set {_LIBRARY}={_bundled_llvm() or '…'} before Python starts"
            )
        return
    elif (bundled := _bundled_llvm()) is not None:
        os.environ[_LIBRARY] = str(bundled)
        return
    else:
        library = _system_llvm() or ""
    error = _probe_llvm(library)
    if error is not None:
        raise DeviceError(
            f"no LLVM library works ({library or 'LLVM'}: {error});"
            f" install one: {_ADVICE.get(platform.system(), 'LLVM 16 or newer')}"
        )
    os.environ[_LIBRARY] = library


def _bundled_llvm() -> Path | None:
    # The wheel karellen-llvm-core puts its library under the environment's lib/
    try:
        files = importlib.metadata.files("karellen-llvm-core") or []
    except importlib.metadata.PackageNotFoundError:
        return None
    names = [f for f in files if f.name.startswith("libLLVM.so.")]
    paths = [Path(str(name.locate())).resolve() for name in names]
    return next((path for path in paths if path.is_file()), None)


def _system_llvm() -> str | None:
    # Try the newest version first; Homebrew's library is outside the search path
    for version in ("", *(f"-{n}" for n in range(30, 15, -1))):
        found = ctypes.util.find_library(f"LLVM{version}")
        if found:
            return found
    roots = Path("/opt/homebrew"), Path("/usr/local")
    brew = [root / "opt/llvm/lib/libLLVM.dylib" for root in roots]
    return next((str(path) for path in brew if path.is_file()), None)


def _cuda_driver() -> str | None:
    name = "nvcuda" if platform.system() == "Windows" else "cuda"
    return ctypes.util.find_library(name)


def _probe_llvm(library: str) -> str | None:
    # Error message of kernels compiled with an LLVM library; None if they run
    if not library:
        return "none was found"
    return _probe(_VARIANT["cpu"], {_LIBRARY: library})


def _probe(variant: str, environment: dict[str, str]) -> str | None:
    # Run a test kernel in a child process; return its error message, None if it runs
    script = Path(__file__).with_name("probe.py")
    try:
        child = subprocess.run(
            [sys.executable, str(script), variant],
            env={**os.environ, **environment},
            capture_output=True,
            text=True,
            timeout=120,
            check=False,
        )
    except subprocess.TimeoutExpired:
        return "a test kernel did not finish in 120 s"
    if child.returncode == 0 and "works" in child.stdout:
        return None
    if child.returncode < 0:
        return f"it aborts the process (signal {-child.returncode})"
    lines = [line for line in child.stderr.strip().splitlines() if line.strip()]
    return lines[-1].strip() if lines else f"exit status {child.returncode}"


def describe() -> list[Finding]:
    """Return the report of `clerestory doctor` on devices and LLVM libraries."""
    findings = [
        Finding("platform", f"{platform.system()} {platform.machine()}", True),
        Finding("python", platform.python_version(), sys.version_info >= (3, 11)),
    ]
    for package in ("clerestory", "mitsuba", "drjit", "numpy"):
        try:
            findings.append(Finding(package, importlib.metadata.version(package), True))
        except importlib.metadata.PackageNotFoundError:
            findings.append(Finding(package, "not installed", False))

    # Test the LLVM library that would be used
    library = os.environ.get(_LIBRARY) or str(_bundled_llvm() or _system_llvm() or "")
    error = _probe_llvm(library)
    advice = _ADVICE.get(platform.system(), "")
    verdict = "works" if error is None else f"{error}; {advice}"
    findings.append(Finding("LLVM", f"{library or '-'}: {verdict}", error is None))

    # Test the GPU if there is a driver
    if _cuda_driver() is None:
        findings.append(Finding("CUDA", "no NVIDIA driver; the CPU is used", True))
    else:
        error = _probe(_VARIANT["cuda"], {})
        findings.append(Finding("CUDA", error or "works", error is None))
    findings.append(Finding("processors", str(os.cpu_count()), True))
    return findings
