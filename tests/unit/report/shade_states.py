"""States of a blind in closed form: each state transmits a share of the light."""

import numpy as np

from clerestory.study.results import Results

SHARES = (1.0, 0.4, 0.1)

# DGP of the states, as parts of that in operation
DGP_SHARES = (1.2, 1.0, 0.7)


def with_states(results):
    """Add the illuminance of the three states of `course`, and façade irradiance."""
    data = results.data
    lux = data["illuminance"].values
    unknown = np.full_like(lux, np.nan)
    parts = np.stack([*(share * lux for share in SHARES), unknown], axis=1)
    state = data["state"].values[0].astype(int)
    operated = (np.take(SHARES, state) * lux).astype(np.float32)
    more = data.assign(
        illuminance=(("sensor", "time"), operated),
        illuminance_by_state=(
            ("sensor", "window", "state_number", "time"),
            parts[:, None].astype(np.float32),
        ),
        glare_dgp_by_state=(
            ("view", "shade_state", "time"),
            data["glare_dgp"].values[:, None] * np.array(DGP_SHARES)[:, None],
        ),
        facade_irradiance=(("window", "time"), (lux[:1] / 10).astype(np.float32)),
    )
    return Results(more, results.run)
