"""Checks of the inputs of a study: geometry, sensors and views."""

import warnings
from dataclasses import replace

from clerestory.errors import ClerestoryWarning
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.recent_values import RecentValues
from clerestory.scene.scene_checks import check_scene
from clerestory.study.annual_views import warn_of_views
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.labels import sensor_labels


def warn_of_inputs(
    study: Study, inputs: Inputs, *, recent: RecentValues | None = None
) -> None:
    """Warn of implausible geometry, and of views into walls or with few pixels.

    `recent` has the findings on the geometry of other variants of the study.
    """
    sensors = replace(inputs.sensors(), names=tuple(sensor_labels(inputs)))
    windows = [group.inner for group in inputs.groups]
    views = {
        table.label: camera.view
        for table, camera in zip(study.view, inputs.cameras, strict=True)
    }
    findings = (recent or RecentValues()).value(
        ("findings", fingerprint(windows, sensors, views)),
        lambda: check_scene(inputs.scene, windows, sensors, views),
        of=(inputs.scene,),
    )
    for finding in findings:
        warnings.warn(finding, ClerestoryWarning, stacklevel=2)
    warn_of_views(study.view, inputs.cameras)
