"""Interreflection in stacks, against one linear system for the fluxes of all gaps."""

import numpy as np
import pytest

from clerestory.glazing.interreflection import stack_properties
from clerestory.glazing.optics import Optics

PATCHES, WAVELENGTHS = 7, 3

# g: specular, coated on one side; s: scattering
STACKS = ["g", "s", "gg", "gs", "sg", "ss", "ggs", "sgg", "gsg", "sgs", "ggsg", "gsgss"]


def fluxes(seed, *, specular):
    """Random flux matrices of a layer that absorbs at most half of the light."""
    rng = np.random.default_rng(seed)
    shape = (WAVELENGTHS, PATCHES, 1 if specular else PATCHES)
    parts = rng.random((2, 2, *shape))
    kept = rng.uniform(0.5, 1, (2, WAVELENGTHS, 1, shape[-1]))
    if specular:
        kept = kept.swapaxes(-1, -2) * np.ones((PATCHES, 1))
        parts *= (kept / parts.sum(axis=1))[:, None]
    else:
        parts *= (kept / parts.sum(axis=(1, 3))[:, :, None])[:, None]
    (t_front, r_front), (t_back, r_back) = parts
    return Optics(t_front, t_back, r_front, r_back)


def full(flux):
    """The matrix of a diagonal."""
    return flux[..., None, :, 0] * np.eye(PATCHES) if flux.shape[-1] == 1 else flux


def one_system(layers):
    """Fluxes that travel each way in every gap, from one solution of all equations.

    Unknowns: flux inwards and outwards in each of the gaps 0…n, where gap 0 is
    outdoors and gap n indoors. The last index of each result is the wavelength.
    """
    n, size = len(layers), PATCHES
    layers = [layer.map(full) for layer in layers]
    system, absorbed = [], []
    for at in range(WAVELENGTHS):
        inwards = {g: slice(g * size, (g + 1) * size) for g in range(n + 1)}
        outwards = {
            g: slice((n + 1 + g) * size, (n + 2 + g) * size) for g in range(n + 1)
        }
        equations = np.eye(2 * (n + 1) * size)
        for k, layer in enumerate(layers):
            equations[inwards[k + 1], inwards[k]] -= layer.transmission_front[at]
            equations[inwards[k + 1], outwards[k + 1]] -= layer.reflection_back[at]
            equations[outwards[k], outwards[k + 1]] -= layer.transmission_back[at]
            equations[outwards[k], inwards[k]] -= layer.reflection_front[at]
        answer = np.linalg.inv(equations)
        light = answer[:, inwards[0]], answer[:, outwards[n]]
        system.append(
            (
                light[0][inwards[n]],
                light[1][outwards[0]],
                light[0][outwards[0]],
                light[1][inwards[n]],
            )
        )
        absorbed.append(
            [
                [
                    (
                        flux[inwards[k]]
                        + flux[outwards[k + 1]]
                        - flux[outwards[k]]
                        - flux[inwards[k + 1]]
                    ).sum(axis=0)
                    for k in range(n)
                ]
                for flux in light
            ]
        )
    return np.moveaxis(system, 0, 1), np.moveaxis(absorbed, 0, 2)


@pytest.mark.parametrize("kinds", STACKS)
def test_a_stack_solves_the_equations_of_all_its_gaps(kinds):
    layers = [fluxes(seed, specular=kind == "g") for seed, kind in enumerate(kinds)]
    system, absorbed = one_system(layers)
    ours = stack_properties(layers)
    for part, theirs in zip(vars(ours.system).values(), system, strict=True):
        assert full(part) == pytest.approx(theirs, abs=1e-12)
    assert ours.absorbed == pytest.approx(absorbed, abs=1e-12)


@pytest.mark.parametrize("kinds", STACKS)
def test_diagonals_and_their_matrices_give_the_same(kinds):
    layers = [fluxes(seed, specular=kind == "g") for seed, kind in enumerate(kinds)]
    short = stack_properties(layers)
    long = stack_properties([layer.map(full) for layer in layers])
    for part, other in zip(
        vars(short.system).values(), vars(long.system).values(), strict=True
    ):
        assert full(part) == pytest.approx(other, abs=1e-12)
    assert short.absorbed == pytest.approx(long.absorbed, abs=1e-12)


@pytest.mark.parametrize("kinds", STACKS)
def test_each_scattering_layer_needs_one_linear_system(kinds, monkeypatch):
    """Two panes and a BSDF were 8 systems and 12 products of matrices; now 1 and 3."""
    solved = []
    solve = np.linalg.solve

    def counted(loop, right):
        solved.append(loop.shape)
        return solve(loop, right)

    monkeypatch.setattr(np.linalg, "solve", counted)
    layers = [fluxes(seed, specular=kind == "g") for seed, kind in enumerate(kinds)]
    stack_properties(layers)
    # One less than the number of scattering layers and of runs of panes
    runs = [kinds[i] for i in range(len(kinds)) if kinds[i : i + 2] != "gg"]
    assert len(solved) == len(runs) - 1
