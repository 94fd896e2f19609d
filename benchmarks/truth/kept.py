"""Results kept in a folder, so that a run that was ended goes on where it was."""

import resource
from collections.abc import Callable
from pathlib import Path

import numpy as np

Arrays = dict[str, np.ndarray]


def processor_seconds() -> float:
    """Return the processor time of this process [s]."""
    spent = resource.getrusage(resource.RUSAGE_SELF)
    return spent.ru_utime + spent.ru_stime


def kept(folder: Path | None, name: str, make: Callable[[], Arrays]) -> Arrays:
    """Return arrays from a folder where they are there, and made otherwise.

    `seconds` is the processor time that they took [s].
    """
    file = folder / f"{name}.npz" if folder else None
    if file and file.exists():
        with np.load(file) as arrays:
            return dict(arrays)
    start = processor_seconds()
    arrays = make()
    arrays["seconds"] = np.array(processor_seconds() - start)
    if file:
        file.parent.mkdir(parents=True, exist_ok=True)
        whole = file.with_suffix(".part.npz")
        np.savez(whole, **arrays)
        whole.rename(file)
    print(f"{name}: {arrays['seconds']:.0f} s", flush=True)
    return arrays
