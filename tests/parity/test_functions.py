"""Function files give what Radiance's own calculator and renderer give."""

import shutil

import numpy as np
import pytest
from radiance import _HOME as HOME
from radiance import run

from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import parse_definitions
from clerestory.radiance.rad_reader import read_rad

# Two inputs, x and y; the last lines use the start file that rcalc is given
EXPRESSIONS = """
x+y*2-x/3; -x^2; x^2^-1; 2^x*y; (x+y)*(x-y)/7; if(x-y, x, y);
select(floor(x)+1, x, y, 7);
min(x,y,.5); max(x,y,.5); floor(x*10)/10; ceil(y*3); sqrt(x); exp(-x); log(y); log10(y);
sin(x); cos(y); tan(x*.3); asin(x/9); acos(x/9); atan(y); atan2(y-1,x-1); rand(x*100);
f(x,y); g(x); h(y); fact(floor(x)+2); curve(x); k;
bound(.5,x,1); Acos(x); Asin(y); Atan2(y,-x); Exp(-x*200); Sqrt(x-1); and(x-1,y-1);
or(x-1,y-1); not(x-1); xor(x-1,y-1); abs(x-y); sgn(x-y); inside(.5,x,1); frac(x*3);
mod(x*7,2); tri(x*7,2); linterp(x,y,3); clip(x-.5); noneg(x-1); grey(x,y,.2);
PI*DEGREE; dot(v,w); cross(2,v,w); clipgrey(x,y,x)
"""
DEFINITIONS = """
{ a comment { within } another }
k : 3*4-2; f(a,b) = a*b + k; g(a) : f(a, a)/2; h(a) = if(a-.5, g(a), -g(a));
fact(n) : if(n-1.5, n*fact(n-1), 1);
curve(t) = ((2*t-3)*t*t+1) + t; v(i) : select(i, 1, 2, 3); w(i) : i*i;
"""


def test_expressions_have_radiances_values(tmp_path):
    expressions = [e.strip() for e in EXPRESSIONS.replace("\n", " ").split(";")]
    channels = "".join(f"${i + 1}={e};" for i, e in enumerate(expressions))
    # rayinit.cal speaks of rays where rcalc has none: leave those lines out
    start = (HOME / "lib" / "rayinit.cal").read_text()
    start = start[: start.index("{ Normal distribution")]
    (tmp_path / "start.cal").write_text(
        start[start.index("{ More robust") :] + DEFINITIONS + "x=$1;y=$2;" + channels
    )
    rng = np.random.default_rng(7)
    points = rng.uniform(0.05, 1.95, (50, 2)).round(6)
    lines = "\n".join(f"{x} {y}" for x, y in points)
    done = run("rcalc -f start.cal", folder=tmp_path, stdin=lines)
    theirs = np.array([line.split() for line in done.splitlines()], dtype=float)

    ours = Program(
        parse_definitions(
            DEFINITIONS + "".join(f"out{i} = {e};" for i, e in enumerate(expressions))
        )
    )
    bodies = tuple(ours.definitions[f"out{i}"].body for i in range(len(expressions)))
    inputs = {"x": points[:, 0], "y": points[:, 1], "S": np.ones(50)}
    computed = ours.values(bodies, inputs)
    # rcalc prints nine digits
    np.testing.assert_allclose(computed.value, theirs, rtol=5.1e-9, atol=1e-12)


LAMP = "pattern light lamp 0 0 3 1 1 1\nlamp polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
PATTERNS = {
    "brightfunc": "brightfunc pattern 2 look own.cal 0 2 .5 3",
    "turned": "brightfunc pattern 10 look own.cal -rx 20 -s 2 -t 1 0 1 0 2 .5 3",
    "colorfunc": "colorfunc pattern 4 noneg(Nz) Rdot abs(Px-U)+.1 own.cal 0 2 1 2",
    "brightdata": "brightdata pattern 5 twice own.dat own.cal Rdot Px 0 1 2",
    "colordata": "colordata pattern 9 twice mix noop own.dat own.dat own.dat own.cal"
    " Rdot Px*.5 0 1 2",
    "modified": "brightfunc first 2 Rdot+.2 . 0 0 first brightfunc pattern 2 A1*Py+1 ."
    " 0 1 3",
}
OWN = """
look = A1 + cheer(Rdot)^A2 * (1 + Px) + Py*Dx*Dx;
cheer(v) : if(v, v, 0);
twice(v) : v*A1; mix(r,g,b) : r + g/2 + b*b;
"""


@pytest.mark.parametrize("kind", PATTERNS)
def test_patterns_on_lamps_look_like_radiances(kind, tmp_path):
    """Rays from 200 viewers to points of a lamp, against rtrace."""
    (tmp_path / "own.cal").write_text(OWN)
    (tmp_path / "own.dat").write_text("2\n0 1 3\n0 0 3\n0 .3 1.2\n1 2 3 2 5 1 4 4 2\n")
    (tmp_path / "lamp.rad").write_text(f"void {PATTERNS[kind]}\n{LAMP}")
    rng = np.random.default_rng(5)
    point = np.column_stack([rng.uniform(0.01, 0.99, (200, 2)), np.zeros(200)])
    viewer = np.column_stack([rng.normal(size=(200, 2)), rng.uniform(0.5, 2, 200)])
    leaves = viewer - point
    leaves /= np.linalg.norm(leaves, axis=1, keepdims=True)
    origin = point + leaves
    lines = "\n".join(
        " ".join(f"{x:.17g}" for x in (*o, *-d))
        for o, d in zip(origin, leaves, strict=True)
    )
    command = "oconv lamp.rad > l.oct && rtrace -h -ab 0 l.oct"
    done = run(command, folder=tmp_path, stdin=lines)
    theirs = np.array([line.split() for line in done.splitlines()], dtype=float)
    pattern = read_rad(tmp_path / "lamp.rad").materials["lamp"].pattern
    up = np.broadcast_to(np.array([0.0, 0.0, 1.0]), leaves.shape)
    np.testing.assert_allclose(
        pattern.value(leaves, up, point), theirs, rtol=3e-6, atol=1e-6
    )


@pytest.mark.parametrize("name", ["skybright.cal", "perezlum.cal", "source.cal"])
def test_our_functions_are_those_of_radiances_files(name, tmp_path):
    """The same primitive, once with our functions and once with Radiance's file."""
    text = {
        "skybright.cal": "void brightfunc p 2 skybr skybright.cal 0"
        " 7 {kind} 40 9 1.2 .3 -.5 .8124038\n",
        "perezlum.cal": "void brightfunc p 2 skybright perezlum.cal 0"
        " 10 8 7 -1 -.3 12 -2.8 .4 .3 -.5 .8124038\n",
        "source.cal": "void brightdata p 5 {kind} t.dat source.cal {phi} src_theta 0"
        " 4 2 .3 .5 .1\n",
    }[name]
    kinds = {
        "skybright.cal": [{"kind": k} for k in (1, 2, 3, 4)],
        "perezlum.cal": [{}],
        "source.cal": [
            {"kind": k, "phi": f}
            for k in ("corr", "flatcorr", "boxcorr", "cylcorr")
            for f in ("src_phi", "src_phi2", "src_phi4", "srcB_horiz", "srcB_vert")
        ],
    }[name]
    rng = np.random.default_rng(11)
    rays = rng.normal(size=(300, 3))
    rays /= np.linalg.norm(rays, axis=1, keepdims=True)
    normal = rng.normal(size=(300, 3))
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    (tmp_path / "t.dat").write_text(
        "2\n-180 360 4\n0 180 3\n" + "1 4 2 5 3 6 1 1 9 2 2 7"
    )
    for kind in kinds:
        (tmp_path / "p.rad").write_text(f"{text.format(**kind)}p light l 0 0 3 1 1 1\n")
        place = (rays, normal, rays) if name == "source.cal" else (rays,)
        native = read_rad(tmp_path / "p.rad").materials["l"].pattern.value(*place)
        shutil.copy(HOME / "lib" / name, tmp_path)
        read = read_rad(tmp_path / "p.rad").materials["l"].pattern.value(*place)
        (tmp_path / name).unlink()
        np.testing.assert_allclose(native, read, rtol=1e-12, atol=1e-12)
