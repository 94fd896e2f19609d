"""The bundled venetian blind against Radiance's genBSDF method on the same geometry."""

import runpy
from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.xml_reader import read_bsdf

pyradiance = pytest.importorskip("pyradiance")
RECIPE = Path(__file__).parents[2] / "scripts" / "make_demo_bsdfs.py"
SLATS, HALF_LENGTH = 101, 1.0


def rectangle(material, name, y, z):
    """Strip of the whole length of the layer between two points (up, inwards)."""
    corners = [(-1, 0), (1, 0), (1, 1), (-1, 1)]
    numbers = " ".join(f"{x * HALF_LENGTH} {y[i]:.7f} {z[i]:.7f}" for x, i in corners)
    return f"{material} polygon {material}.{name} 0 0 12 {numbers}\n"


def layer(recipe):
    """Scene of the layer for Radiance (x right, y up, z inwards) and its depth [m]."""
    tau, rho = recipe["pane_transmissivity"](), recipe["REFLECTANCE"]
    scene = f"void plastic slat 0 0 5 {rho} {rho} {rho} 0 0\n"
    scene += f"void glass pane 0 0 4 {tau:.6f} {tau:.6f} {tau:.6f} {recipe['INDEX']}\n"
    section, spacing = recipe["slat_section"](), recipe["SPACING"]
    for slat in range(SLATS):
        y, z = (section + np.array([(slat - SLATS // 2) * spacing, 0])).T
        for i in range(len(y) - 1):
            scene += rectangle("slat", f"{slat}.{i}", y[i : i + 2], z[i : i + 2])
    depth = recipe["AIR_GAP"] - section[:, 1].min()
    top = SLATS // 2 * spacing
    for name, behind in (("inner", depth), ("outer", depth + recipe["PANE_GAP"])):
        scene += rectangle("pane", name, (-top, top), (-behind, -behind))
    return scene, depth + recipe["PANE_GAP"]


@pytest.mark.slow
def test_blind_agrees_with_genbsdf(tmp_path):
    """`genBSDF -ab 12 -ad 1`, 2000 rays a patch, both ways (seeded by time).

    Integrals over the sky and over the room, which average the noise, agree to 2 %.
    """
    recipe = runpy.run_path(str(RECIPE))
    scene, depth = layer(recipe)
    (tmp_path / "layer.rad").write_text(scene)
    half = recipe["SPACING"] / 2
    traced = pyradiance.generate_bsdf(
        tmp_path / "layer.rad",
        params=["-ab", "12", "-ad", "1", "-lw", "1e-5", "-lr", "-14"],
        nsamp=2000,
        dim=pyradiance.genbsdf.SamplingBox(-half, half, -half, half, -depth, 0),
    )
    (tmp_path / "layer.xml").write_bytes(pyradiance.generate_xml(vis_results=traced))
    theirs = read_bsdf(tmp_path / "layer.xml").function("transmission_front")
    folder = RECIPE.parents[1] / "src" / "clerestory" / "demo"
    ours = read_bsdf(folder / "venetian_blind.xml").function("transmission_front")

    lam = ours.incidents.projected_solid_angles()
    share = ours.direct_hemispherical()
    spread = share / theirs.direct_hemispherical() - 1
    assert np.sqrt(np.mean(spread**2)) < 0.06
    assert share @ lam == pytest.approx(theirs.direct_hemispherical() @ lam, rel=0.02)

    # Compare what goes up and down from a source above and a source below
    height = ours.exits.centres()[:, 1]
    for incident in (ours.incidents.centres()[:, 1] < -0.3, height > 0.3):
        for leaving in (height > 0.05, height < -0.05):
            ours_part, theirs_part = (
                lam[leaving] @ part.values[np.ix_(leaving, incident)] @ lam[incident]
                for part in (ours, theirs)
            )
            assert ours_part == pytest.approx(theirs_part, rel=0.05)
