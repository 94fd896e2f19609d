"""Tracing of the matrices of a study.

Matrices are read from the cache or traced. Each matrix is traced once for all time
steps, independently of the shade operation.
"""

from collections.abc import Sequence
from dataclasses import replace
from functools import partial

from clerestory.bands import RGB
from clerestory.engine.effort import Effort
from clerestory.errors import InputError
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.direct_light import blackened
from clerestory.phases.facade_matrices import facade_daylight, facade_matrices
from clerestory.phases.fingerprint import fingerprint
from clerestory.phases.matrix_equation import (
    MatrixChain,
    Skies,
    WindowMatrices,
    window_chain,
)
from clerestory.phases.methods import METHODS
from clerestory.phases.recent_values import RecentValues
from clerestory.phases.stored_views import (
    StoredColumns,
    store_views,
    stored_columns,
    with_few_components,
)
from clerestory.phases.traced_matrices import (
    daylight_matrices,
    daylight_matrix,
    view_matrices,
)
from clerestory.sky.daylight_spectra import DaylightSpectra
from clerestory.sky.measured_spectra import read_measured_spectra
from clerestory.sky.sky_conditions import Spectrum
from clerestory.sky.sky_matrix import sky_matrix
from clerestory.sky.sun_matrix import SunMatrix, patch_suns, sun_matrix
from clerestory.sky.weather import Weather
from clerestory.spectral.band_sets import band_set
from clerestory.study.config import Study
from clerestory.study.differentiated_materials import checked_materials
from clerestory.study.inputs import Inputs
from clerestory.study.job import STATE, Job
from clerestory.study.memory_size import is_stored, most_sensors
from clerestory.study.study_coefficients import coefficients, direct_suns
from clerestory.study.study_matrices import StudyMatrices
from clerestory.study.window_groups import WindowGroup, state_label

# Offsets added to the random seed for façade matrices and for D of ports
FACADE, PORTS = 0x100000, 0x200000


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


def trace_study(job: Job, *, spectrum: Spectrum = "visible") -> StudyMatrices:
    """Return the sensor matrices of a study, from the cache if possible.

    `spectrum` is that of the irradiance of the suns.
    """
    study, direct = job.study, needs_direct(job.study)
    method, stored = METHODS[study.method], is_stored(study, job.inputs, direct=direct)
    rules = [window.control.rule for window in study.window if window.control]
    if "LM-83" in rules and not direct:
        raise InputError(
            f'rule "LM-83" with the {study.method} method requires direct light;'
            ' [sun] places = "exact" expected'
        )
    job = replace(job, derivatives=checked_materials(study, job.scene, stored=stored))
    weather = job.inputs.weather
    tables = study.sun.model_dump(), study.sky.model_dump(), study.scene.bands
    suns = job.recent.value(
        ("suns", study.corrected, fingerprint(tables), spectrum),
        lambda: study_suns(study, weather, spectrum=spectrum),
        of=(weather,),
    )
    black = job
    if job.inputs.groups:
        # Direct light is scattered by windows only: all other surfaces are black
        black = replace(job, inputs=replace(job.inputs, scene=blackened(job.scene)))
    if method.windows:
        windows = _windows(job, black, direct=direct, stored=stored)
    else:
        windows = coefficients(job, direct=direct)
    if suns is not None:
        sunlit = zip(windows, direct_suns(black, suns), strict=True)
        windows = [replace(window, sun=sun) for window, sun in sunlit]
    if not stored:
        return StudyMatrices(study.terms, tuple(windows), suns, recent=job.recent)
    most = most_sensors(study, job.inputs, direct=direct)
    return StudyMatrices(
        study.terms, tuple(windows), suns, job.scratch, most, recent=job.recent
    )


def differentiated_matrices(job: Job, names: Sequence[str]) -> list[WindowMatrices]:
    """Return the matrices of all light, with derivatives by materials of the scene.

    View matrices are in memory. The direct light of a method has no derivatives by
    reflectances: it is scattered by windows only.

    Raises
    ------
    InputError : no such material, or derivatives that do not fit into memory
    """
    job = replace(job, derivatives=tuple(names))
    if not METHODS[job.study.method].windows:
        return coefficients(job, direct=False)
    return [WindowMatrices(chain) for chain in _window_chains(job, stored=False)]


def _windows(
    job: Job, black: Job, *, direct: bool, stored: bool
) -> list[WindowMatrices]:
    # V, T and D of each window, and V_d, T and D_d of the black scene
    whole = _window_chains(job, stored=stored)
    dark: Sequence[MatrixChain | None] = [None] * len(whole)
    if direct:
        dark = _window_chains(replace(black, direct=True), stored=stored)
    return list(map(WindowMatrices, whole, dark))


def _window_chains(job: Job, *, stored: bool) -> list[MatrixChain]:
    # V, T and D (or F D) of each window; V is traced for all windows together
    views: Sequence[TransferMatrix | StoredColumns] = _views(job, stored=stored)
    chains = []
    for number, (group, view) in enumerate(zip(job.inputs.groups, views, strict=True)):
        daylight = window_daylight(job, group, number)
        if stored:
            daylight = [with_few_components(matrix) for matrix in daylight]
        T = [state.transmission for state in group.states]
        chains.append(window_chain(view, T, daylight * (len(T) // len(daylight))))
    return chains


def _views(job: Job, *, stored: bool) -> Sequence[TransferMatrix | StoredColumns]:
    sensors, effort = job.inputs.sensors(), job.effort()
    windows = [group.inner for group in job.inputs.groups]
    if job.direct:
        # The path from the sensor to the window counts as one bounce
        effort = replace(effort, bounces=1)
    if not stored:
        trace = partial(
            view_matrices, job.scene, windows, sensors=sensors, **job.differentiated
        )
        found = job.matrices("view", windows, trace, effort, shown="view matrices")
        return list(found.values())
    key = fingerprint("views", job.scene_key, windows, sensors, effort)
    views = store_views(
        partial(job.blocks, f"{job.prefix}views", key),
        job.scene,
        windows,
        sensors=sensors,
        effort=effort,
        progress=job.display(f"{job.prefix}view matrices"),
    )
    return stored_columns(views, windows)


def window_daylight(job: Job, group: WindowGroup, number: int) -> list[TransferMatrix]:
    """Return D, common to all shade states, or F D of each shade state."""
    if METHODS[job.study.method].facade and group.ports:
        D = _port_daylight(job, group, number)
        states = range(len(group.states))
        return [facade_daylight(_facade(job, group, number, at), D) for at in states]
    # The random seed differs between windows, and from the seed of view matrices
    subdivision = job.study.sky.subdivision
    matrix = job.matrix(
        f"daylight-{group.name}",
        partial(
            daylight_matrix,
            job.scene,
            group.outer,
            subdivision=subdivision,
            **job.differentiated,
        ),
        _outside_effort(job, 1 + number),
        shown=f"daylight matrix of {group.name}",
    )
    return [matrix]


def _outside_effort(job: Job, stream: int) -> Effort:
    effort = job.effort(stream)
    return replace(effort, bounces=0) if job.direct else effort


def _port_daylight(
    job: Job, group: WindowGroup, number: int
) -> dict[str, TransferMatrix]:
    # D of each port, traced without the exterior shade
    subdivision = job.study.sky.subdivision
    return job.matrices(
        f"daylight-{group.name}",
        group.ports,
        partial(
            daylight_matrices,
            job.scene,
            group.ports,
            subdivision=subdivision,
            **job.differentiated,
        ),
        _outside_effort(job, PORTS + STATE * number),
        shown=f"daylight matrices of the ports of {group.name}",
    )


def _facade(
    job: Job, group: WindowGroup, number: int, at: int
) -> dict[str, TransferMatrix]:
    # F of each port, with the exterior shade in one state
    shade, label = group.states[at].shade, state_label(group, at)
    scene = job.scene + (blackened(shade) if job.direct else shade)
    return job.matrices(
        f"facade-{label}",
        group.ports,
        partial(facade_matrices, scene, group.outer, group.ports, **job.differentiated),
        _outside_effort(job, FACADE + number + STATE * at),
        shown=f"façade matrices of {label}",
    )
