"""Model of a recipe: its selected sensor grids, and their records for results."""

from dataclasses import dataclass, field, replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import final

from clerestory.checks import one_of, require
from clerestory.errors import located
from clerestory.escaping import file_stem
from clerestory.formats.building_model import BuildingModel
from clerestory.formats.floor_grids import floor_grids
from clerestory.formats.hbjson import read_hbjson
from clerestory.metrics.honeybee_writer import GridRecord
from clerestory.metrics.procedure import cell_area
from clerestory.study.model_import import check_bsdfs

# Spacing and height of the grids of models without grids [m]
_SPACING, _HEIGHT = 0.5, 0.76


@final
@dataclass(frozen=True, eq=False)
class RecipeModel:
    """A model whose grids are those to simulate, with a record for each grid.

    `programs` are the names of the uses of the rooms, by identifier of the grid; rooms
    without one are left out.
    """

    model: BuildingModel
    records: dict[str, GridRecord]
    programs: dict[str, str] = field(default_factory=dict)

    @property
    def grids(self) -> tuple[GridRecord, ...]:
        """Records of the grids, in the order of the model."""
        return tuple(self.records.values())

    def cell_areas(self) -> dict[str, float]:
        """Floor area that a sensor represents [m²], by identifier of the grid."""
        return {
            record.full_id: cell_area(self.model.grids[name].position)
            for name, record in self.records.items()
        }


def read_model(
    path: Path, *, grid_filter: str = "*", window_groups: bool = False
) -> RecipeModel:
    """Read a model, and select the grids whose identifier matches a pattern.

    The pattern applies to the identifier alone, or after its group and a slash. A model
    without grids has grids above the floors of its rooms. `window_groups`: see
    `read_hbjson`.

    Raises
    ------
    InputError : the file is no HBJSON file, or no grid matches
    """
    with located(file=path):
        model = _read(path, window_groups=window_groups)
        if not model.grids:
            made = floor_grids(model, spacing=_SPACING, height=_HEIGHT)
            omitted = (*model.unsupported, *made.omitted)
            model = replace(
                model, grids=made.grids, labels=made.labels, unsupported=omitted
            )
        records = _records(model)
        chosen = {
            name: record
            for name, record in records.items()
            if fnmatchcase(record.identifier, grid_filter)
            or fnmatchcase(record.full_id, grid_filter)
        }
        known = ", ".join(record.full_id for record in records.values()) or "none"
        message = f"no sensor grid matches {grid_filter!r}; one of {known} expected"
        require(chosen, message)
    grids = {name: model.grids[name] for name in chosen}
    labels = {name: model.labels[name] for name in chosen}
    uses = {room.identifier: room.program for room in model.rooms if room.program}
    programs = {
        record.full_id: uses[labels[name].room]
        for name, record in chosen.items()
        if labels[name].room in uses
    }
    selected = replace(model, grids=grids, labels=labels, rooms=())
    return RecipeModel(selected, chosen, programs)


def read_model_views(path: Path, *, view_filter: str = "*") -> RecipeModel:
    """Read a model without its grids, and select the views whose name matches.

    Raises
    ------
    InputError : the file is no HBJSON file, or no view matches
    """
    with located(file=path):
        model = _read(path)
        views = {n: v for n, v in model.views.items() if fnmatchcase(n, view_filter)}
        known = ", ".join(model.views) or "none"
        message = f"no view matches {view_filter!r}; one of {known} expected"
        require(views, message)
    return RecipeModel(replace(model, grids={}, labels={}, rooms=(), views=views), {})


def _read(path: Path, *, window_groups: bool = False) -> BuildingModel:
    kinds = ".hbjson", ".json"
    one_of(path.suffix.lower(), "type of the model", choices=kinds)
    model = read_hbjson(path, window_groups=window_groups)
    check_bsdfs(model)
    return model


def _records(model: BuildingModel) -> dict[str, GridRecord]:
    # Repeated identifiers are replaced by the names, which are unique
    found: dict[str, GridRecord] = {}
    taken: set[tuple[str, str]] = set()
    for name, label in model.labels.items():
        group = file_stem(label.group) if label.group else ""
        stem = file_stem(label.identifier)
        if (group, stem.casefold()) in taken:
            stem = f"{file_stem(name)}~{len(found)}"
        taken.add((group, stem.casefold()))
        found[name] = GridRecord(name, stem, len(model.grids[name]), group)
    return found
