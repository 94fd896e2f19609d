"""Directions worth a scan: among those that predict badly, away from all others."""

import numpy as np
import pytest

from clerestory.gonio.angles import angle_between, from_degrees
from clerestory.gonio.cross_validation import CrossValidation, LeftOut
from clerestory.gonio.measurement_planning import recommended_directions
from goniometer import half_circle


def validation_with(share):
    """Errors of 81 scans of half a circle: a share of the light put elsewhere."""
    incidents = half_circle()
    theta = np.degrees(np.arccos(np.clip(incidents[:, 2], -1, 1)))
    phi = np.degrees(np.arctan2(incidents[:, 1], incidents[:, 0]))
    shares = share(incidents)
    return CrossValidation(
        tuple(
            LeftOut(float(t), float(p), True, 0.5, 0.5, 1.0, 1.0, float(s), 0.01)
            for t, p, s in zip(theta, phi, shares, strict=True)
        ),
        1.0,
    )


def test_directions_are_recommended_near_badly_predicted_scans():
    validation = validation_with(
        lambda incident: np.where(incident[:, 1] > 0.3, 0.8, 0.02)
    )
    found = recommended_directions(validation, symmetry="bilateral-x", count=20)
    assert found.shape == (20, 3)
    assert np.linalg.norm(found, axis=1) == pytest.approx(1)
    assert np.all(found[:, 1] > 0.2)
    assert np.all(found[:, 0] >= 0)
    assert np.all(found[:, 2] >= np.cos(np.radians(80)) - 1e-9)


def test_no_direction_is_measured_twice():
    """Even errors: the widest gaps are filled, and none is less than a degree wide."""
    validation = validation_with(lambda incident: np.full(len(incident), 0.5))
    found = recommended_directions(validation, symmetry="bilateral-x", count=40)
    every = np.concatenate([half_circle(), found])
    apart = angle_between(every[:, None], found) + 9 * np.eye(121)[:, 81:]
    assert np.degrees(apart.min()) > 3


def test_an_isotropic_layer_gets_polar_angles_of_its_own_plane():
    scans = tuple(
        LeftOut(t, 180.0, True, 0.5, 0.5, 1.0, 1.0, 0.3, 0.01) for t in (10.0, 30, 70)
    )
    found = recommended_directions(
        CrossValidation(scans, 1.0), symmetry="isotropic", count=1
    )
    assert np.degrees(angle_between(found[0], from_degrees(50.0, 180.0))) < 1
