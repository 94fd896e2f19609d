"""Names by which tables of a study file refer to other tables."""

from typing import TYPE_CHECKING

from clerestory.study.config_tables import require_rule
from clerestory.study.window_tables import WindowTable

if TYPE_CHECKING:
    from clerestory.study.config import Study


def require_names(study: "Study") -> None:
    """Raise a validation error unless all names in a study are those of its tables."""
    # Control rules, lighting zones, view grids and luminaires name other tables
    grids = [table.label for table in study.sensors]
    views = [table.label for table in study.view]
    view_grids = [table.label for table in study.view_grid]
    for window in study.window:
        if window.control is not None:
            rule = f'rule "{window.control.rule}" of window "{window.label}"'
            named = [window.control.grid, window.control.eye_grid]
            _require(rule, "grid", named, grids)
            _require(rule, "view", window.control.views, views)
            _require(rule, "view grid", window.control.view_grids, view_grids)
            _require_views(study, window)
            _require_model(study, window)
    for table in study.view_grid:
        _require(f'view grid "{table.label}"', "grid", [table.grid], grids)
    _require("[output] spectral", "grid", study.output.spectral, grids)
    _require_energy_names(study)
    for space in study.space:
        _require(f'space "{space.name}"', "grid", space.grids, grids)
        _require(f'space "{space.name}"', "view", space.views, views)
    zones = [table.label for table in study.lighting]
    for zone in study.lighting:
        _require(f'lighting "{zone.label}"', "grid", [zone.grid], grids)
    for lamp in study.luminaire:
        what = f'luminaire "{lamp.label}"'
        _require(what, "lighting zone", [lamp.zone], zones)
        require_rule(
            lamp.zone or len(zones) < 2,
            f"{what} without zone; one of {', '.join(zones)} expected",
        )
    require_rule(
        bool(study.luminaire) == bool(study.lighting),
        "[[luminaire]] or [[lighting]] without the other table; both expected",
    )


def _require_energy_names(study: "Study") -> None:
    zones = [table.label for table in study.lighting]
    if study.energy is not None:
        windows = [window.label for window in study.window]
        named = [each.name for each in study.energy.window]
        _require("[energy]", "window", named, windows)
        for each in study.energy.lights:
            message = f'[energy] refers to lighting zone "{each.zone}"; one of'
            known = ", ".join(zones) or "none"
            require_rule(each.zone in zones, f"{message} {known} expected")


def _require_model(study: "Study", window: WindowTable) -> None:
    control = window.control
    if control is None:
        return
    zone = control.rule in ("cooling season", "predictive")
    thermal = (
        "outdoor temperature",
        "zone temperature",
        "heating load",
        "cooling load",
    )
    known = study.energy is not None and window.label in {
        each.name for each in study.energy.window
    }
    require_rule(
        known or not (zone or control.quantity in thermal),
        f'rule "{control.rule}" of window "{window.label}" depends on the zone, but'
        " there is no table [[energy.window]] of this window; one expected",
    )


def _require_views(study: "Study", window: WindowTable) -> None:
    control = window.control
    if control is None or control.eye_grid:
        return
    if control.rule == "glare" and control.grid:
        return
    glare = control.rule == "glare" or "glare" in control.needs
    require_rule(
        study.view or study.view_grid or not (glare or control.dgp_below is not None),
        f'rule "{control.rule}" of window "{window.label}" depends on glare, but'
        " there is no view; a table [[view]] or [[view_grid]] expected",
    )


def _require(what: str, kind: str, names: list[str], known: list[str]) -> None:
    for name in names:
        require_rule(
            not name or name in known,
            f'{what} refers to {kind} "{name}"; one of {", ".join(known) or "none"}'
            " expected",
        )
