"""Annual glare of an office with three façades against full Radiance renderings.

The data set is raytraverse's (see `benchmarks/annual_glare_reference.py`): clear glass,
translucent glass above, and glossy metal opposite; three views each. Radiance's
vertical illuminance is within 1.2 % of converged path tracing, in ten hours.
"""

import numpy as np
import pytest
from annual_glare_office import (
    FACADES,
    ours,
    reference,
    scene_of,
    skies_of,
    views_of,
    weather_of,
)


@pytest.fixture(scope="module")
def office(shared_data):
    folder = shared_data / "annual_glare"
    if not folder.is_dir():
        pytest.skip(f"reference data are not here: {folder} is missing")
    return folder


def compared(office, facade, views, every):
    """Errors of illuminance and DGP in some views and in every so many hours."""
    lux, dgp = [], []
    hours = reference(office, facade, 0)["ann_hour"].astype(int)[::every]
    scene, skies = scene_of(office, facade), skies_of(weather_of(office, hours))
    every_view = views_of(office, facade)
    for number in views:
        truth = reference(office, facade, number)[::every]
        found = ours(scene, every_view[number], skies)
        lux.append(abs(found.lux / truth["illum"] - 1).mean())
        dgp.append(abs(found.dgp - truth["dgp"]).mean())
    return np.mean(lux), np.mean(dgp)


def test_office_with_translucent_glass(office):
    """One view of the façade that scatters the sun, in 60 hours."""
    lux, dgp = compared(office, FACADES[1], [2], 34)
    assert lux < 0.03
    assert dgp < 0.0075


@pytest.mark.slow
@pytest.mark.parametrize("facade", FACADES, ids=lambda facade: facade.name)
def test_every_facade(office, facade):
    """Mean absolute errors over the views of a façade, in 60 hours."""
    lux, dgp = compared(office, facade, range(3), 34)
    assert lux < 0.03
    assert dgp < 0.0075
