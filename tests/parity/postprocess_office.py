"""Print LEED and EN 17037 of a results folder as honeybee-radiance-postprocess does.

Run by its own interpreter: FOLDER of results, and CELLS as JSON: the side of a square
cell [m] and the number of sensors of each grid. Written for this comparison.
"""

import json
import sys
from pathlib import Path

import numpy as np
from honeybee.model import Model
from honeybee_radiance.sensorgrid import SensorGrid
from honeybee_radiance_postprocess.en17037 import en17037_compute
from honeybee_radiance_postprocess.leed.leed import leed_option_one
from honeybee_radiance_postprocess.results.annual_daylight import AnnualDaylight
from ladybug_geometry.geometry3d.mesh import Mesh3D
from ladybug_geometry.geometry3d.pointvector import Point3D


def strip(side, count):
    """Mesh of `count` square cells in a row."""
    corners = [Point3D(side * k, side * j, 0) for k in range(count + 1) for j in (0, 1)]
    faces = [(2 * k, 2 * k + 2, 2 * k + 3, 2 * k + 1) for k in range(count)]
    return Mesh3D(corners, faces)


folder, cells = Path(sys.argv[1]), json.loads(sys.argv[2])
model = Model("office", [])
grids = []
for name, (side, count) in cells.items():
    grids.append(SensorGrid.from_mesh3d(name, strip(side, count)))
model.properties.radiance.add_sensor_grids(grids)
(folder.parent / "office.hbjson").write_text(json.dumps(model.to_dict()))
summary, each, *_ = leed_option_one(AnnualDaylight(str(folder)), use_states=True)
levels = {}
for file in sorted(folder.glob("daylight_hours_*.npy")):
    lux = np.load(file)
    info = {"full_id": file.stem, "count": len(lux)}
    kinds = en17037_compute(lux, info)["target_types"]
    levels[file.stem.removeprefix("daylight_hours_")] = {
        kind: [int(part["compliance_level"][0])]
        + [row["sda"] for row in part["levels"].values()]
        for kind, part in kinds.items()
    }
print(json.dumps({"all": summary, "each": each, "en17037": levels}))  # noqa: T201
