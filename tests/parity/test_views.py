"""Rays and sizes of views against vwrays."""

import numpy as np
import pytest
from radiance import run

from clerestory.radiance.view_text import format_view, parse_view

VIEWS = {
    "perspective": "-vtv -vp 1 -2 1.5 -vd 1 2 -.3 -vu 0 .1 1 -vh 65 -vv 45",
    "perspective, off axis": "-vtv -vd 0 1 0 -vh 60 -vv 40 -vs .4 -vl -.3 -vo .5",
    "perspective, clipped": "-vtv -vd 1 1 0 -vh 60 -vv 40 -vo .5 -va 3",
    "parallel": "-vtl -vp 1 2 3 -vd 1 1 -1 -vh 6 -vv 4 -vs .1 -vl .2 -vo .5",
    "hemispherical": "-vth -vp 3 2 1 -vd 0 -1 .2 -vh 180 -vv 180",
    "hemispherical, cut": "-vth -vd 1 -1 .2 -vh 90 -vv 120 -vs .2 -vo .1",
    "angular": "-vta -vp 3 2 1 -vd 0 -1 0 -vh 180 -vv 180",
    "angular, all round": "-vta -vd 1 0 0 -vh 360 -vv 360 -vl .1 -vo .2",
    "planisphere": "-vts -vd 1 0 1 -vu 0 1 0 -vh 200 -vv 180 -vs -.1",
    "cylindrical": "-vtc -vp 1 1 1 -vd 1 0 .2 -vh 360 -vv 90 -vo .3",
    "cylindrical, cut": "-vtc -vd 0 1 0 -vh 120 -vv 60 -vs .5 -vl .25",
}


@pytest.mark.parametrize("options", VIEWS.values(), ids=VIEWS)
def test_rays_are_those_of_vwrays(options, tmp_path):
    view = parse_view(options)
    columns, rows = view.size_for((25, 21))
    size = run(f"vwrays -x 25 -y 21 {options} -d", folder=tmp_path).split()
    assert [columns, rows] == [int(size[1]), int(size[3])]
    text = run(f"vwrays -fa -x 25 -y 21 -pj 0 {options}", folder=tmp_path)
    table = np.array(text.split(), dtype=float).reshape(rows, columns, 6)
    length = np.linalg.norm(table[..., 3:], axis=-1)
    rays = view.rays(columns, rows)
    assert np.array_equal(rays.valid, length > 0)
    assert np.abs(rays.origin - table[..., :3]).max() < 2e-5
    assert np.abs(rays.direction * length[..., None] - table[..., 3:]).max() < 2e-5
    if view.aft:
        reach = view.reach(rays.direction)
        assert np.allclose(reach, length, rtol=1e-5)


@pytest.mark.parametrize("options", VIEWS.values(), ids=VIEWS)
def test_radiance_reads_the_views_we_write(options, tmp_path):
    view = parse_view(options)
    (tmp_path / "a.vf").write_text(f"rvu {format_view(view)}\n")
    ours = run("vwrays -x 7 -y 7 -vf a.vf", folder=tmp_path)
    theirs = run(f"vwrays -x 7 -y 7 {options}", folder=tmp_path)
    assert np.allclose(
        np.array(ours.split(), float), np.array(theirs.split(), float), atol=2e-5
    )
