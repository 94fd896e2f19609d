"""Annual daylight behind complex fenestration: BSDFs, matrix methods, error bars.

The names below are the public interface; each is loaded when it is first used,
so that `import clerestory` is fast and needs no compute device. Public functions check
the types of their arguments.
"""

import importlib
import inspect
from typing import Any

_HOME = {
    "ClerestoryError": "errors",
    "ClerestoryWarning": "errors",
    "InputError": "errors",
    "Bands": "bands",
    "band_set": "spectral.band_sets",
    "wavelength_bands": "spectral.band_sets",
    "band_means": "spectral.band_sets",
    "equivalent_daylight_illuminance": "spectral.alpha_opic",
    "Axis": "matrix.axis",
    "TransferMatrix": "matrix.transfer_matrix",
    "expanded_illuminance": "matrix.expansion",
    "read_matrix": "matrix.radiance_format",
    "write_matrix": "matrix.radiance_format",
    "klems": "hemisphere.klems",
    "reinhart": "hemisphere.reinhart",
    "Bsdf": "bsdf.bsdf",
    "read_bsdf": "library.bsdf_source",
    "write_bsdf": "bsdf.xml_writer",
    "read_measurement": "gonio.measurement_files",
    "fit_measurement": "gonio.fitted_measurement",
    "measured_bsdf": "gonio.fitted_measurement",
    "cross_validate": "gonio.cross_validation",
    "generate_bsdf": "bsdfgen.generate",
    "read_layer": "library.layer_source",
    "read_system": "library.system_file",
    "stack_layers": "glazing.stack",
    "walk_layers": "glazing.layer_random_walk",
    "thermal_figures": "glazing.thermal",
    "StateSchedule": "control.schedule",
    "Weather": "sky.weather",
    "SkyMatrix": "sky.sky_matrix",
    "read_weather": "sky.weather_formats",
    "select_days": "sky.weather_selection",
    "sky_matrix": "sky.sky_matrix",
    "sun_matrix": "sky.sun_matrix",
    "SunMatrix": "sky.sun_matrix",
    "DaylightSpectra": "sky.daylight_spectra",
    "Scene": "scene.model",
    "in_bands": "scene.band_conversion",
    "material_parameters": "scene.material_parameters",
    "with_parameters": "scene.material_parameters",
    "Sensors": "scene.sensors",
    "View": "scene.view",
    "Window": "scene.window",
    "read_rad": "radiance.rad_reader",
    "read_obj": "formats.obj",
    "read_hbjson": "formats.hbjson",
    "read_ifc": "formats.ifc",
    "read_gltf": "formats.gltf",
    "read_luminaire": "formats.photometry.read",
    "luminaire_scene": "formats.photometry.luminaire_scene",
    "panel_scene": "formats.photometry.luminaire_scene",
    "read_sensors": "scene.sensors",
    "parse_view": "radiance.view_text",
    "read_view": "radiance.view_text",
    "Camera": "image.camera",
    "Picture": "image.picture",
    "read_picture": "image.picture_files",
    "write_picture": "image.picture_files",
    "denoise": "image.denoise",
    "read_window": "radiance.window_reader",
    "read_windows": "radiance.window_reader",
    "view_matrix": "phases.traced_matrices",
    "view_matrices": "phases.traced_matrices",
    "daylight_matrix": "phases.traced_matrices",
    "daylight_matrices": "phases.traced_matrices",
    "daylight_coefficients": "phases.traced_matrices",
    "illuminance_derivatives": "phases.illuminance_derivatives",
    "WindowMatrices": "phases.matrix_equation",
    "Skies": "phases.matrix_equation",
    "window_chain": "phases.matrix_equation",
    "THREE_PHASE": "phases.methods",
    "FIVE_PHASE": "phases.methods",
    "three_phase": "phases.methods",
    "five_phase": "phases.methods",
    "picture_view_matrices": "phases.picture_matrices",
    "reflected_view_matrices": "phases.picture_matrices",
    "picture_window_paths": "phases.window_paths",
    "blackened": "phases.direct_light",
    "ShadedWindow": "phases.shaded_windows",
    "ShadeState": "phases.shaded_windows",
    "receiving_matrices": "phases.shaded_windows",
    "pictures_over_time": "phases.picture_series",
    "luminance_over_time": "phases.picture_series",
    "facade_matrix": "phases.facade_matrices",
    "facade_matrices": "phases.facade_matrices",
    "facade_daylight": "phases.facade_matrices",
    "Cluster": "cluster.cluster",
    "Effort": "engine.effort",
    "irradiance": "phases.rendering",
    "render": "phases.rendering",
    "render_irradiance": "phases.rendering",
    "render_progressively": "phases.rendering",
    "DgpError": "glare.dgp_goal",
    "precompute_illums": "phases.window_emitters",
    "write_illums": "radiance.illum_table",
    "sky_at": "radiance.generated_sky",
    "sky_scene": "radiance.generated_sky",
    "false_colour": "image.false_colour",
    "write_display": "image.srgb_display",
    "evaluate_glare": "glare.evaluate",
    "annual_glare": "glare.annual_glare",
    "trace_view_point": "glare.view_point_tracer",
    "glare_changes": "glare.glare_changes",
    "glazed_view_glare": "glare.glazed_view_points",
    "calibrate_study": "comparison.calibration_run",
    "compare_series": "comparison.series_comparison",
    "simulated_series": "comparison.series",
    "read_measured_series": "comparison.mapping",
    "read_study": "study.config",
    "run_study": "study.study_run",
    "read_variants": "study.variants",
    "run_variants": "study.variant_run",
}

__version__ = "0.2.0"
__all__ = sorted([*_HOME, "__version__"])


def __getattr__(name: str) -> Any:
    if name not in _HOME:
        raise AttributeError(f"module 'clerestory' has no attribute {name!r}")
    value = getattr(importlib.import_module(f"clerestory.{_HOME[name]}"), name)
    if inspect.isfunction(value):
        check = importlib.import_module("clerestory.argument_types")
        value = check.checked_arguments(value)
    globals()[name] = value
    return value


def __dir__() -> list[str]:
    return __all__
