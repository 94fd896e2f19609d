"""Function files in kernels compute what they compute over NumPy's arrays."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from clerestory.engine import device as devices

# Mitsuba and Dr.Jit exist once a device was started
devices.load("cpu")

import drjit as dr
import mitsuba as mi

from clerestory.engine.function_code import FunctionCode
from clerestory.engine.pattern_code import multiplier, share
from clerestory.errors import InputError
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import Name, parse_definitions, parse_expression
from clerestory.radiance.data_array import DataArray
from clerestory.radiance.function_pattern import FunctionPattern
from clerestory.scene.material import Source

RNG = np.random.default_rng(1)
X, Y, Z = RNG.uniform(-3, 3, (3, 400))
FILE = """
twice(x) = 2*x; apply(f, x) : f(f(x)); width = A1 + A2; turn(x) = x - floor(x + .5);
turbulence(s) : if(s - 1.01, 0, abs(noise3(Px/s, Py/s, Pz/s)*s) + turbulence(2*s));
fall(n) = if(n - .5, n*fall(n - 1), 1);
"""
EXPRESSIONS = """
Px + 2*Py - Pz/3; -Px^2; Px^3; 2^Py; (Py*Py)^.3; sqrt(Px); log(Py); log10(Px*Px + 1);
exp(Px); sin(Px) + cos(Py)*tan(Pz/3); asin(Px/2); acos(Py/2); atan(Px); atan2(Py, Px);
floor(Px) + ceil(Py); erf(Px) - erfc(Py); min(Px, Py, Pz) + max(1, Px);
if(Px, Py, sqrt(Py)); if(1, Px, 1/0); select(2, Px, Py, Pz); select(Px + 3, 1, 2, 3);
select(0, 1, 2, 3); 1/(Px - Px); Px/Py; P(1) + P(2)*P(3); bound(-1, Px, 1); Acos(Px);
Asin(Py); Atan2(Px, Py); Exp(-200*Px*Px); Sqrt(Px); and(Px, Py); or(Px, Py); not(Px);
xor(Px, Py); abs(Px); sgn(Px); sq(Px); inside(-1, Px, 1); frac(Px); mod(Px, .7);
tri(Px, .7); linterp(Px, Py, Pz); hermite(1, 2, 3, 4, Px); bezier(1, 2, 4, 3, Px);
bspline(1, 2, 4, 3, Px); clip(Px); noneg(Px); red(Px, Py, Pz); grey(Px, Py, Pz);
clipgrey(Px, Py, Pz); rand(Px); noise3(Px, Py, Pz); noise3x(Px, Py, Pz);
noise3b(Px, Py, Pz); noise3z(9*Px, 9*Py, 9*Pz); twice(Px); apply(twice, Px);
width*Px; arg(2) + arg(0); A1; AC; arg(1.5 + .2*frac(Px)); turbulence(.1); fall(6);
PI*DEGREE; turn(Px); Px^Py; (-2)^3; dot(P, P); cross(1, P, P)
"""


def in_kernel(text, program, arguments):
    """Values, and where they are faulty."""
    inputs = {"P" + a: mi.Float64(v) for a, v in zip("xyz", (X, Y, Z), strict=True)}
    made = FunctionCode(program, inputs, arguments).value(parse_expression(text))
    value = np.broadcast_to(mi.Float64(made.value).numpy(), X.shape)
    bad = np.broadcast_to(mi.Bool(made.bad).numpy(), X.shape)
    return value, bad


def over_arrays(text, program, arguments):
    """The same by `Program`, which the parity tests compare with Radiance."""
    inputs = {"Px": X, "Py": Y, "Pz": Z, "S": np.ones(len(X))}
    made = program.values((parse_expression(text),), inputs, arguments)
    return made.value[:, 0], ~made.valid


@pytest.mark.parametrize("text", [t.strip() for t in EXPRESSIONS.split(";")])
def test_kernels_compute_what_arrays_do(device, text):
    program, arguments = Program(parse_definitions(FILE)), (0.5, 1.25)
    value, bad = in_kernel(text, program, arguments)
    expected, faulty = over_arrays(text, program, arguments)
    np.testing.assert_array_equal(bad, faulty)
    np.testing.assert_allclose(value[~bad], expected[~bad], rtol=1e-9, atol=1e-9)


LEAVES = st.sampled_from(["Px", "Py", "Pz", ".5", "2", "3.25"])
TREES = st.recursive(
    LEAVES,
    lambda inner: st.one_of(
        st.tuples(inner, st.sampled_from("+-*/"), inner).map(
            "({0[0]}{0[1]}{0[2]})".format
        ),
        inner.map("sqrt({})".format),
        inner.map("(-{})".format),
        st.tuples(inner, inner, inner).map("if({0[0]},{0[1]},{0[2]})".format),
        st.tuples(inner, inner).map("min({0[0]},{0[1]})".format),
    ),
    max_leaves=8,
)


@settings(max_examples=40, deadline=None, derandomize=True)
@given(text=TREES)
def test_any_expression_is_computed_alike(text):
    value, bad = in_kernel(text, Program(), ())
    expected, faulty = over_arrays(text, Program(), ())
    np.testing.assert_array_equal(bad, faulty)
    np.testing.assert_allclose(value[~bad], expected[~bad], rtol=1e-7, atol=1e-9)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("fall(Px)", "nested calls; a recursion that ends"),
        ("fnoise3(Px, Py, Pz)", '"fnoise3" is not defined for patterns'),
        ("there", '"there" is not defined for patterns'),
        ("arg(3)", "real argument 3 is used, but the primitive has 2"),
    ],
)
def test_what_kernels_cannot_do_is_reported_before_tracing(device, text, message):
    pattern = FunctionPattern(
        Program(parse_definitions(FILE)),
        (parse_expression(text),),
        (1.0, 2.0),
        source=Source("room.rad", 7),
    )
    with pytest.raises(InputError, match=message) as caught:
        multiplier(pattern, np.zeros(3))
    assert str(caught.value).startswith("room.rad:7: ")


@pytest.mark.parametrize("axes", [1, 2, 3])
def test_tables_are_read_as_over_arrays(device, axes):
    """Even and uneven axes, growing and falling, inside and far outside."""
    positions = ([-2.0, 0.0, 1.0], [3.0, 1.0, -1.0, -1.5], [0.0, 1.0])[:axes]
    values = RNG.uniform(0, 1, [len(p) for p in positions])
    table = DataArray(tuple(np.array(p) for p in positions), values)
    places = tuple(parse_expression(f"2*P{a}") for a in "xyz"[:axes])
    pattern = FunctionPattern(
        Program(), (Name("noop"),), tables=(table,), coordinates=places
    )
    points = np.stack([X, Y, Z], axis=1)
    up = np.tile([0.0, 0.0, 1.0], (len(points), 1))
    si = dr.zeros(mi.SurfaceInteraction3f, len(points))
    si.p = mi.Point3f(np.ascontiguousarray(points.T.astype("f4")))
    si.n = mi.Normal3f(0, 0, 1)
    si.sh_frame = mi.Frame3f(si.n)
    si.wi = mi.Vector3f(0, 0, 1)
    expected = pattern.value(up, up, points)[:, 0]
    found = multiplier(pattern, np.zeros(3))(si).numpy()[0]
    np.testing.assert_allclose(found, expected, rtol=1e-4, atol=1e-4)
    part = share(pattern, np.zeros(3))(si).numpy()
    np.testing.assert_allclose(part, np.clip(expected, 0, 1), rtol=1e-4, atol=1e-4)
