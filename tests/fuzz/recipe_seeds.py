"""Inputs of recipes: small sound files."""

import json
from pathlib import Path

import numpy as np
from honeybee_models import aperture, honeybee_model, office
from reader import Reader

INPUTS = {
    "model": "model.hbjson",
    "wea": "hour.wea",
    "north": 12.5,
    "thresholds": "-t 300 -lt 100 -ut 3000",
    "radiance-parameters": "-ab 2 -ad 500 -c 2",
    "schedule": None,
}
POSITIONS = "1 2 1.2\n# desk\n3 2 1.2 0 0 1\n"
RANGES = [
    {"maximum": 500, "minimum": 100},
    {"anyOf": [{"minimum": 3000}, {"allOf": [{"maximum": 10}, {"minimum": 1}]}]},
]


def _model(_: Path) -> list[bytes]:
    pane = [[1, 0, 1], [3, 0, 1], [3, 0, 2], [1, 0, 2]]
    group = {"dynamic_group_identifier": "south", "states": [{"modifier": "tint"}]}
    switched = aperture("light", pane, modifier="pane", **group)
    rooms = office(), office(south={"apertures": [switched]})
    return [json.dumps(honeybee_model(room)).encode() for room in rooms]


def _viewed(_: Path) -> list[bytes]:
    model = honeybee_model(office())
    seen = {"position": [1, 2, 1.2], "direction": [0, -1, 0], "up_vector": [0, 0, 1]}
    view = {"type": "View", "identifier": "desk", "view_type": "v", **seen}
    model["properties"].setdefault("radiance", {})["views"] = [view]
    return [json.dumps(model).encode()]


def _inputs(found, path):
    from clerestory.recipes.recipe import RECIPES

    return found(path, RECIPES["annual-daylight"].inputs)


def _hours(found, path):
    return found(path, np.arange(24.0))


def _written(found, path):
    from clerestory.formats.hbjson import read_hbjson
    from clerestory.study.model_import import write_building_model

    model = found(path)
    return write_building_model(read_hbjson(path), path.parent / "study"), model


READERS = {
    "recipe inputs": Reader(
        "recipes.inputs:read_inputs",
        "inputs.json",
        (json.dumps(INPUTS),),
        beside={"model.hbjson": "{}", "hour.wea": ""},
        use=_inputs,
    ),
    "recipe schedule": Reader(
        "recipes.inputs:occupied_steps",
        "hours.csv",
        ("\n".join(["0", "1"] * 4380),),
        use=_hours,
    ),
    "recipe ranges": Reader(
        "recipes.grid_summary:read_ranges", "ranges.json", (json.dumps(RANGES),)
    ),
    "recipe model": Reader(
        "recipes.model:read_model", "model.hbjson", make=_model, use=_written
    ),
    "recipe views": Reader(
        "recipes.model:read_model_views", "model.hbjson", make=_viewed
    ),
    "positions": Reader("scene.sensors:read_positions", "eyes.txt", (POSITIONS,)),
}
