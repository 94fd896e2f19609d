"""Choice whether matrices and hourly results are kept in memory or in files.

Matrices in files have fewer error components. The choice depends on the study alone, so
that all machines give the same results.
"""

import warnings

from clerestory.engine.channels import channels_of
from clerestory.engine.sums import BATCHES
from clerestory.errors import ClerestoryWarning
from clerestory.hemisphere.reinhart import reinhart
from clerestory.phases.methods import METHODS
from clerestory.phases.separate_coefficients import has_proxies
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs

# Bytes of a coefficient in double precision, with its error components
_COEFFICIENT = 8 + 4 * BATCHES

# Bytes of a coefficient in single precision, without error components
_SINGLE = 4

# Maximum number of (sensor, time) arrays in memory: illuminance, its error and error
# components, copies for writing, and copies for the report
_HOURLY = 14


def is_stored(study: Study, inputs: Inputs, *, direct: bool) -> bool:
    """Whether V or C, those of direct light, and hourly results are kept in files."""
    each = _sensor_bytes(study, inputs, coefficient=_COEFFICIENT, direct=direct)
    whole = len(inputs.sensors()) * each * 1e-9
    large = whole > study.trace.memory_gb
    if large and not _can_use_files(study, inputs, direct=direct):
        warnings.warn(
            f"the {study.method} method keeps all matrices in memory, about"
            f" {whole:.1f} GB; only the three- and four-phase methods, and the"
            " two-phase method without window groups, can use files",
            ClerestoryWarning,
            stacklevel=2,
        )
        return False
    return large


def _can_use_files(study: Study, inputs: Inputs, *, direct: bool) -> bool:
    if METHODS[study.method].windows:
        return not study.corrected
    # Proxied geometry requires that C_d is traced separately
    return not (inputs.groups or (direct and has_proxies(inputs.scene)))


def most_sensors(study: Study, inputs: Inputs, *, direct: bool) -> int:
    """Return the maximum number of sensors whose matrices fit into memory together."""
    each = _sensor_bytes(study, inputs, coefficient=_SINGLE, direct=direct)
    return int(study.trace.memory_gb * 1e9) // each


def _sensor_bytes(
    study: Study, inputs: Inputs, *, coefficient: int, direct: bool
) -> int:
    # Bytes of memory for the coefficients and hourly results of one sensor
    if METHODS[study.method].windows:
        patches = sum(len(group.inner.partition) for group in inputs.groups)
        patches *= 2 if direct else 1
    else:
        # C, C_d, and C_ds of about as many suns as there are sky patches
        states = sum(len(group.states) for group in inputs.groups)
        sky = len(reinhart(study.sky.subdivision))
        patches = max(1, states) * sky * (3 if direct else 1)
    coefficients = patches * channels_of(inputs.scene)
    hours, arrays = len(inputs.weather.times), _HOURLY
    if study.output.by_state:
        counts = [len(group.states) for group in inputs.groups]
        arrays += 2 * len(counts) * max(counts)
    return int(coefficient * coefficients + 4 * arrays * hours)
