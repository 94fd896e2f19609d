"""Annual heat map of illuminance, for the mean of each grid and for single sensors.

The page contains the mean of each grid, and as many evenly spaced sensors as the limit
of its size allows.
"""

import numpy as np
from jaxtyping import Float

from clerestory.report.colour import colour_bar, illuminance_scale, value_colours
from clerestory.report.content import ReportContent
from clerestory.report.embedded_data import CODE_STEP, illuminance_codes, packed, png
from clerestory.report.heat_map import DARKEST_LUX, heat_map
from clerestory.report.markup import render
from clerestory.report.period import evenly
from clerestory.report.section import Section

# Maximum number of illuminances on a page: about 3 MB after compression
_MOST_VALUES = 1_500_000


def year_section(content: ReportContent) -> Section:
    """Return the annual heat map of illuminance and the list of selectable series."""
    grid = content.grid
    scale = illuminance_scale(content.illuminance, low=DARKEST_LUX)
    series = _series(content)
    names = [name for name, _, _ in series]
    image = grid.fill(series[0][2])[::-1]
    known = np.isfinite(image)
    body = render(
        "year.html",
        darkest=f"{DARKEST_LUX:.0f}",
        gaps=bool(np.any(np.diff(grid.dates) > np.timedelta64(1, "D"))),
        names=names,
        rated=bool({"glare_dgp", "grid_view_dgp"} & set(content.data.variables)),
        carried=sum(sensor is not None for _, sensor, _ in series),
        total=len(content.sensors),
        drawing=heat_map(
            grid,
            image=png(value_colours(scale, np.where(known, image, 0)), known),
            occupied=content.occupied,
            label=f"{names[0]}: illuminance by day and hour",
        ),
        bar=colour_bar(scale),
    )
    data = {
        "dates": grid.dates.astype(int).tolist(),
        "bins": grid.bins,
        "cell": packed(grid.cell.astype(np.uint32)),
        "code_step": CODE_STEP,
        "low": scale.smallest,
        "high": scale.largest,
        "colours": scale.table().tolist(),
        "series": [
            {"name": name, "sensor": sensor, "codes": packed(illuminance_codes(lux))}
            for name, sensor, lux in series
        ],
    }
    return Section(body, {"year": data})


def _series(
    content: ReportContent,
) -> list[tuple[str, int | None, Float[np.ndarray, " time"]]]:
    # For each series: name, sensor index (None for a grid mean) and illuminance
    lux, names = content.illuminance, content.sensors.names
    means = [
        (f"Mean of {grid} ({len(members):,} sensors)", None, lux[members].mean(axis=0))
        for grid, members in content.sensors.by_grid().items()
    ]
    most = max(1, _MOST_VALUES // len(content.times))
    return [*means, *((names[k], k, lux[k]) for k in evenly(len(names), most))]
