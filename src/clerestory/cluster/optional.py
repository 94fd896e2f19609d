"""Optional import of dask.distributed (extra `cluster`)."""

import importlib
from types import ModuleType
from typing import Any

from clerestory.errors import DeviceError, InputError

# Timeout of the connection to a scheduler [s]
_PATIENCE = 10


def load() -> ModuleType:
    """Return dask.distributed.

    Raises
    ------
    DeviceError : dask.distributed is not installed
    """
    try:
        return importlib.import_module("distributed")
    except ImportError as error:
        raise DeviceError(
            "a cluster requires dask.distributed; pip install 'clerestory[cluster]'"
        ) from error


def load_worker() -> ModuleType:
    """Return the module with the worker functions."""
    return importlib.import_module("clerestory.cluster.worker")


def connect(dask: ModuleType, address: str) -> Any:
    """Return a client of the scheduler at an address.

    Raises
    ------
    InputError : no scheduler responds at the address
    """
    try:
        return dask.Client(address, timeout=_PATIENCE, set_as_default=False)
    except (OSError, ValueError, TimeoutError) as error:
        raise InputError(
            f"no dask scheduler answers at {address!r}; an address such as"
            " tcp://10.0.0.1:8786 expected"
        ) from error


def losses(dask: ModuleType) -> tuple[type[BaseException], ...]:
    """Return the exception types raised when a worker and its data are lost."""
    client = importlib.import_module("distributed.client")
    killed = importlib.import_module("distributed.scheduler").KilledWorker
    return client.FutureCancelledError, killed, OSError
