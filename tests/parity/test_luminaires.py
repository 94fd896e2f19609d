"""Luminaires look and send what those of Radiance's ies2rad do."""

import numpy as np
import pytest
from radiance import run

from clerestory.formats.photometry.luminaire_scene import luminaire_scene
from clerestory.formats.photometry.read import read_luminaire
from clerestory.radiance.rad_reader import read_rad

# Flux of the whole luminaire [lm]: as the files themselves tell it
FLUX = {"1.IES": 9217, "2.IES": 5834, "4.IES": 5822, "5.IES": 754}


@pytest.mark.parametrize("name", [*FLUX, "3.IES", "examp1.ies"])
def test_radiance_is_that_of_ies2rad(name, shared_data, tmp_path):
    """The radiance of its surfaces in 300 directions, against rtrace; ours two ways.

    ies2rad prints six digits, and lower faces are seen from below only.
    """
    file = shared_data / "photometry" / name
    run(f"ies2rad -t default -o lamp '{file}'", folder=tmp_path)
    (tmp_path / "ours.rad").write_text(f'!ies2rad -o lamp "{file}"\n')
    lamp = read_luminaire(file)
    read = read_rad(tmp_path / "ours.rad").materials["lamp_light"].pattern
    built = luminaire_scene(lamp).materials["luminaire"].pattern

    leaves = np.random.default_rng(8).normal(size=(300, 3))
    leaves /= np.linalg.norm(leaves, axis=1, keepdims=True)
    leaves = leaves[np.abs(leaves[:, 2]) > 0.01]
    lines = "\n".join(" ".join(f"{x:.17g}" for x in (*(9 * d), *-d)) for d in leaves)
    command = "oconv lamp.rad > l.oct && rtrace -h -ab 0 l.oct"
    done = run(command, folder=tmp_path, stdin=lines)
    theirs = np.array([line.split() for line in done.splitlines()], dtype=float)
    normal = np.zeros_like(leaves)
    normal[:, 2] = np.sign(leaves[:, 2])
    shown = theirs[:, 0] > 0
    assert shown.mean() > 0.4
    for pattern in (read, built):
        ours = pattern.value(leaves, normal, np.zeros_like(leaves))
        np.testing.assert_allclose(
            ours[shown], theirs[shown], rtol=2e-5, atol=1e-5 * theirs.max()
        )


def test_surfaces_are_those_of_ies2rad(shared_data, tmp_path):
    for name in ("1.IES", "2.IES", "5.IES", "examp1.ies"):
        file = shared_data / "photometry" / name
        run(f"ies2rad -t default -o lamp '{file}'", folder=tmp_path)
        (tmp_path / "ours.rad").write_text(f'!ies2rad -o lamp "{file}"\n')
        theirs = {s.name: s for s in read_rad(tmp_path / "lamp.rad").surfaces}
        for surface in read_rad(tmp_path / "ours.rad").surfaces:
            other = theirs.pop(surface.name)
            assert type(surface) is type(other)
            for field in ("vertices", "centre", "outer_radius", "normal"):
                if hasattr(surface, field):
                    one, two = getattr(surface, field), getattr(other, field)
                    np.testing.assert_allclose(
                        np.sort(np.ravel(one)), np.sort(np.ravel(two)), atol=6e-4
                    )
        assert not theirs


@pytest.mark.parametrize("name", FLUX)
def test_flux_is_what_the_file_says(name, shared_data):
    """Files give whole lumens, from finer measurements than they hold."""
    lamp = read_luminaire(shared_data / "photometry" / name)
    assert lamp.flux() == pytest.approx(FLUX[name], rel=1e-3)


def test_flux_of_eulumdat_is_its_light_output_ratio(shared_data):
    lamp = read_luminaire(shared_data / "photometry" / "fluorescent_luminaire.ldt")
    assert lamp.flux() == pytest.approx(lamp.lamp_lumens * 0.403, rel=2e-3)
