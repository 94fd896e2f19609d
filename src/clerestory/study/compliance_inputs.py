"""Quantities that standards require besides hourly illuminance and glare.

Height of the sensors above the floor, view out, daylight factors under the CIE overcast
sky, daylight hours and the median of the diffuse illuminance.
"""

from dataclasses import replace
from functools import partial

import numpy as np
import xarray as xr
from jaxtyping import Float

from clerestory.constants import LUMINOUS_EFFICACY
from clerestory.engine.device import Device
from clerestory.metrics.en17037 import daylight_hours
from clerestory.metrics.view_out import Opening, view_out
from clerestory.phases.illuminance import illuminance
from clerestory.phases.matrix_equation import Skies, Term
from clerestory.phases.unscattered_light import first_surfaces
from clerestory.sky.gensky import cie_sky
from clerestory.sky.point_sky import sky_vector
from clerestory.sky.sky_conditions import sky_conditions
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs
from clerestory.study.spaces import label_spaces
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.sunlight_exposure import openings, sunlight

# Diffuse horizontal irradiance of the overcast sky of daylight factors [W/m²]
_OVERCAST = 100.0

# Greatest distance to furniture and thickness of a table top below a sensor, and
# greatest height of a sensor above the floor [m]
_FURNITURE, _SKIN, _HIGHEST = 0.3, 0.06, 2.0

_DOWN = np.array([0.0, 0.0, -1.0])


def compliance_inputs(
    study: Study, inputs: Inputs, matrices: StudyMatrices
) -> xr.Dataset:
    """Return sunlight exposure, spaces and, with [compliance], inputs of standards."""
    sunny = sunlight(study, inputs)
    if study.compliance is None and not study.space:
        return sunny
    labels = label_spaces(study, inputs, sunny)
    parts = [sunny, labels]
    if study.compliance is not None:
        device: Device = "auto" if study.trace.cluster else study.trace.device
        height = _heights(inputs, device)
        parts += [
            xr.Dataset({"height_above_floor": ("sensor", height, {"units": "m"})}),
            _daylight_factors(study, inputs, matrices),
        ]
        if study.assesses("EN 17037"):
            parts += [_daylight_hours(inputs)]
            if "opening_space" in labels:
                parts += [_views(study, inputs, labels, height, device)]
    return xr.merge(parts, combine_attrs="no_conflicts", join="outer")


def _heights(inputs: Inputs, device: Device) -> Float[np.ndarray, " sensor"]:
    # Height above the floor, as median of the grid [m]
    points = inputs.sensors().position
    reach = _below(inputs, points, device)

    # Surfaces just below the sensors are furniture, if there is a floor below them
    near = reach < _FURNITURE
    under = points - [0.0, 0.0, 1.0] * (np.where(near, reach, 0.0) + _SKIN)[:, None]
    deeper = reach + _SKIN + _below(inputs, under, device)
    reach = np.where(near & (deeper < _HIGHEST), deeper, reach)
    heights = np.zeros(len(points))
    for grid in inputs.grids:
        rows = inputs.rows(grid)
        known = reach[rows][np.isfinite(reach[rows])]
        heights[rows] = np.median(known) if len(known) else np.inf
    return heights


def _below(inputs: Inputs, points: np.ndarray, device: Device) -> np.ndarray:
    down = np.broadcast_to(_DOWN, points.shape)
    return first_surfaces(inputs.scene, points, down, device=device)[0]


def _views(
    study: Study, inputs: Inputs, labels: xr.Dataset, height: np.ndarray, device: Device
) -> xr.Dataset:
    # View out of each sensor through the openings of its space, at eye height
    assert study.compliance is not None
    eyes = inputs.sensors().position.copy()
    floor = eyes[:, 2] - np.where(np.isfinite(height), height, 0.0)
    eyes[:, 2] = floor + study.compliance.eye_height
    every = [
        Opening(polygon.vertices, window.frame.normal)
        for window in openings(study, inputs)
        for polygon in window.polygons
    ]
    owner, of_opening = labels["space"].values, labels["opening_space"].values
    cast = partial(first_surfaces, inputs.scene, device=device)
    count = len(eyes)
    width, distance = np.zeros(count), np.zeros(count)
    layers = np.zeros(count, dtype=np.int8)
    for name in dict.fromkeys(owner.tolist()):
        rows = np.flatnonzero(owner == name)
        if not name:
            continue
        # Without tables [[space]], several grids may share a room
        own = [
            opening
            for opening, space in zip(every, of_opening, strict=True)
            if space == name or not study.space
        ]
        width[rows], distance[rows], layers[rows] = view_out(eyes[rows], own, cast)
    return xr.Dataset(
        {
            "view_width": ("sensor", width, {"units": "degree"}),
            "view_distance": ("sensor", distance, {"units": "m"}),
            "view_layers": ("sensor", layers),
        }
    )


def _daylight_factors(
    study: Study, inputs: Inputs, matrices: StudyMatrices
) -> xr.Dataset:
    # Daylight factors with all shades open, with their errors and error components
    sky = cie_sky(
        "overcast",
        sun_altitude=np.pi / 4,
        sun_azimuth=np.pi,
        diffuse_horizontal=_OVERCAST,
        ground_reflectance=study.sky.ground_reflectance,
    )
    bands = inputs.scene.bands
    white = replace(sky, bands=bands, colour=(1.0,) * len(bands))
    skies = Skies(sky_vector(white, subdivision=study.sky.subdivision))
    found = illuminance(matrices.windows, (Term("illuminance", "whole"),), skies)
    outdoors = LUMINOUS_EFFICACY * _OVERCAST
    once = found.isel(time=0, drop=True).drop_vars("sensor", errors="ignore")
    named = {
        "daylight_factor": once["illuminance"] / outdoors,
        "daylight_factor_error": once["standard_error"] / outdoors,
    }
    if "error_components" in once:
        named["daylight_factor_components"] = once["error_components"]
    return xr.Dataset(named).drop_attrs(deep=True)


def _daylight_hours(inputs: Inputs) -> xr.Dataset:
    # The half of the time steps with most diffuse light, and its median illuminance
    hours = daylight_hours(inputs.weather.diffuse_horizontal)
    visible = sky_conditions(inputs.weather).diffuse_horizontal
    median = (
        LUMINOUS_EFFICACY * float(np.median(visible[hours])) if hours.any() else 0.0
    )
    return xr.Dataset(
        {"daylight_hours": ("time", hours)}, attrs={"median_diffuse_lux": median}
    )
