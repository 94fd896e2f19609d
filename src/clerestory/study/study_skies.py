"""Skies of a study, and the suns of its weather."""

from functools import partial

from clerestory.bands import RGB
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import (
    Skies,
)
from clerestory.phases.methods import METHODS
from clerestory.phases.recent_values import RecentValues
from clerestory.sky.daylight_spectra import DaylightSpectra
from clerestory.sky.measured_spectra import read_measured_spectra
from clerestory.sky.sky_conditions import Spectrum
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import SunMatrix, patch_suns, sun_matrix
from clerestory.sky.weather import Weather
from clerestory.spectral.band_sets import band_set
from clerestory.study.config import Study
from clerestory.study.inputs import Inputs


def study_skies(
    study: Study,
    inputs: Inputs,
    suns: SunMatrix | None,
    *,
    spectrum: Spectrum = "visible",
    recent: RecentValues | None = None,
) -> Skies:
    """Return sky matrices S and, if required, S_ds and S_sun, in the scene's bands.

    S_ds is required by terms of direct light, and if the sun alone is uncertain.

    `recent` has the skies of other variants of the study.
    """
    make = partial(
        sky_matrix,
        inputs.weather,
        subdivision=study.sky.subdivision,
        ground_reflectance=study.sky.ground_reflectance,
        rotation_deg=study.sky.rotation_deg,
        sun_formula=study.sky.sun_formula,
        bands=inputs.scene.bands,
        daylight=_daylight_spectra(study) if spectrum == "visible" else None,
        spectrum=spectrum,
    )
    direct = needs_direct(study) or _separates_sun(study)
    key = fingerprint(study.sky.model_dump(), inputs.scene.bands, spectrum, direct)

    def skies() -> Skies:
        return Skies(make(), make(include="sun") if direct else None, suns)

    return (recent or RecentValues()).value(
        ("skies", key), skies, size=_bytes, of=(inputs.weather, suns)
    )


def _separates_sun(study: Study) -> bool:
    table = study.uncertainty
    return table is not None and any(u.kind in ("sky", "sun") for u in table.unknown)


def _bytes(skies: Skies) -> float:
    parts = (skies.whole, skies.sun)
    return float(sum(sky.diffuse.nbytes for sky in parts if sky is not None))


def needs_direct(study: Study) -> bool:
    """Whether an equation term or the LM-83 rule requires matrices of direct light."""
    rules = [window.control.rule for window in study.window if window.control]
    named = any(term.part == "direct" for term in study.terms)
    return named or (METHODS[study.method].windows and "LM-83" in rules)


def study_suns(
    study: Study, weather: Weather, *, spectrum: Spectrum = "visible"
) -> SunMatrix | None:
    """Return the sun positions of the direct-sun correction; None if not corrected."""
    if not study.corrected:
        return None
    make = patch_suns
    if study.sun.places == "exact":
        make = partial(sun_matrix, tolerance_deg=study.sun.tolerance_deg)
    return make(
        weather,
        rotation_deg=study.sky.rotation_deg,
        sun_formula=study.sky.sun_formula,
        spectrum=spectrum,
        bands=band_set(study.scene.bands),
        daylight=_daylight_spectra(study) if spectrum == "visible" else None,
    )


def _daylight_spectra(study: Study) -> DaylightSpectra | None:
    # Spectra of sky and sun; none in RGB
    if band_set(study.scene.bands) == RGB:
        return None
    table = study.sky.daylight
    sky, sun = (
        None if file is None else read_measured_spectra(file)
        for file in (table.sky_file, table.sun_file)
    )
    models = table.model_dump(exclude={"sky_file", "sun_file"})
    return DaylightSpectra(**models, measured_sky=sky, measured_sun=sun)
