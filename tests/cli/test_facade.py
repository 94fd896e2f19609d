"""The façade matrix on the command line, and products that hold it."""

from pathlib import Path

import numpy as np
import pytest

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.matrix.netcdf import read_netcdf
from clerestory.matrix.radiance_format import read_matrix

PORT = """#@rfluxmtx h=kq u=Z
void polygon {name}
0 0
12 4 -0.5 {low}  0 -0.5 {low}  0 -0.5 {high}  4 -0.5 {high}
"""
FACADE = "trace facade --scene room.rad --window window.rad --port ports.rad"
EFFORT = "--samples 64 --format double"


@pytest.fixture
def ports(room):
    """Ports of two groups, one above the other."""
    (room / "ports.rad").write_text(
        PORT.format(name="low", low=0, high=1.5).replace("void", "below")
        + PORT.format(name="high", low=1.5, high=3).replace("void", "above")
    )


def daylight(call, ports):
    """D of the ports, and a sky."""
    command = f"trace daylight --scene room.rad --window {ports} --sky-subdivision 1"
    assert call(*f"{command} {EFFORT} -o D.nc".split()).status == 0
    sky = "sky matrix two_days.wea --subdivision 1 -o S.smx --format double"
    assert call(*sky.split()).status == 0


def test_each_port_writes_a_file(call, ports):
    outcome = call(*f"{FACADE} {EFFORT} -o F.mtx".split())
    assert outcome.status == 0, outcome.err
    assert outcome.out.count("standard error of the row sums") == 2
    for name in ("below", "above"):
        assert read_matrix(f"F-{name}.mtx").values.shape == (3, 41, 41)


def test_five_factors_multiply_as_in_python(call, ports):
    whole = PORT.format(name="whole", low=0, high=3).replace("void", "front")
    Path("ports.rad").write_text(whole)
    assert call(*f"{FACADE} {EFFORT} -o F.nc".split()).status == 0
    daylight(call, "ports.rad")
    view = "trace view --scene room.rad --window window.rad --sensors desk.pts"
    assert call(*f"{view} {EFFORT} -o V.nc".split()).status == 0
    chain = "V.nc diffuser.xml F.nc D.nc S.smx"
    outcome = call(*f"multiply {chain} -o E.nc".split())
    assert outcome.status == 0, outcome.err
    V, F, D = (read_netcdf(f"{name}.nc") for name in "VFD")
    T = read_bsdf("diffuser.xml").transmission_matrix()
    expected = (V @ T @ F @ D).values @ read_matrix("S.smx").values
    found = read_netcdf("E.nc")
    assert expected.max() > 0
    np.testing.assert_allclose(found.values, expected, rtol=1e-4)
    assert found.standard_error.max() > 0


def test_products_of_several_ports_add_up(call, ports):
    assert call(*f"{FACADE} {EFFORT} -o F.nc".split()).status == 0
    daylight(call, "ports.rad")
    command = "multiply F-below.nc D-below.nc + F-above.nc D-above.nc -o FD.nc"
    outcome = call(*command.split())
    assert outcome.status == 0, outcome.err
    parts = [
        read_netcdf(f"F-{port}.nc") @ read_netcdf(f"D-{port}.nc")
        for port in ("below", "above")
    ]
    found = read_netcdf("FD.nc")
    expected = parts[0].values + parts[1].values
    assert expected.max() > 0
    np.testing.assert_allclose(found.values, expected, rtol=1e-6)
    assert (found.rows.kind, found.columns.kind) == ("exterior", "sky")


def test_daylight_of_another_port_is_refused(call, ports):
    assert call(*f"{FACADE} {EFFORT} -o F.nc".split()).status == 0
    daylight(call, "ports.rad")
    outcome = call("multiply", "F-below.nc", "D-above.nc", "-o", "FD.nc")
    assert outcome.status == 2
    assert "of window 'below' as columns, D-above.nc has" in outcome.err


def test_sums_of_other_shapes_are_refused(call, ports):
    daylight(call, "ports.rad")
    command = "multiply D-below.nc S.smx + diffuser.xml diffuser.xml -o E.nc"
    outcome = call(*command.split())
    assert outcome.status == 2
    assert "diffuser.xml has" in outcome.err
    assert outcome.err.count("\n") == 1
