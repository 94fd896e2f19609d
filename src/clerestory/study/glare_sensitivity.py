"""Changes of the annual glare of a study's views for other reflectances.

Each view is sampled by cells of the sphere around its point, as view grids are.
"""

from dataclasses import replace

import numpy as np
import xarray as xr

from clerestory.errors import InputError
from clerestory.glare.glare_changes import GlareOperation, view_point_changes
from clerestory.glare.sphere_refinement import Refinement
from clerestory.glare.view_point_tracer import ViewPointTracer
from clerestory.phases.matrix_equation import States
from clerestory.scene.material_parameters import material_parameters
from clerestory.study.annual_views import sees_glare
from clerestory.study.control_inputs import ControlInputs
from clerestory.study.differentiated_materials import checked_materials
from clerestory.study.job import VIEW_GRIDS
from clerestory.study.view_matrices import shaded_windows

# Paths per cell for V, and to the windows
_SAMPLES, _SUN_SAMPLES = 512, 128

# Largest number of cells: fewer than for glare itself, as changes are smooth
_MOST = 3000

# Difference of the seeds from those of view grids
_SEED = 0x80000


def glare_sensitivity(signals: ControlInputs, states: States) -> xr.Dataset:
    """Return the changes of annual glare; empty if the study does not ask for them.

    Raises
    ------
    InputError : no view that is wide enough for glare, or a material that cannot be
        changed
    """
    study, job = signals.study, signals.job
    if study.sensitivity is None or not study.sensitivity.glare or job is None:
        return xr.Dataset()
    cameras = zip(study.view, signals.inputs.cameras, strict=True)
    eyes = [(t.label, camera.view) for t, camera in cameras if sees_glare(camera.view)]
    if not eyes:
        raise InputError(
            "[sensitivity] glare without a view that is wide enough for glare; an"
            " angular or hemispherical view of 180° expected"
        )
    names = checked_materials(study, job.scene, stored=False)
    parameters = material_parameters(job.scene, names)
    windows, terms = shaded_windows(job, signals.matrices), signals.matrices.terms
    tracer = ViewPointTracer(job.scene, windows, signals.skies, tuple(terms))
    parts, report = [], job.display("sensitivity of glare")
    for number, (name, view) in enumerate(eyes):
        report(number / len(eyes), name)
        effort = job.pixel_effort(_SAMPLES, VIEW_GRIDS + _SEED * (1 + number))
        position = np.asarray(view.position, dtype=float)
        found = view_point_changes(
            tracer,
            tracer.blank(position, [view], Refinement(most=_MOST)),
            GlareOperation(states, signals.occupied),
            parameters=parameters,
            step=study.sensitivity.step,
            effort=replace(effort, progress=None),
            sun_samples=_SUN_SAMPLES,
        )
        parts.append(found)
    report(1.0, "done")
    # What has no axis of views is the same for all
    whole = xr.concat(
        parts, "view", data_vars="minimal", coords="minimal", compat="override"
    )
    return whole.assign_coords(view=[name for name, _ in eyes])
