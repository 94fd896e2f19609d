"""Built-in replacements for the function files of Radiance's library.

Functions of skies and luminaires are written in Python; those for smooth normals
(`gensurf`, `genrev`, `obj2rad`) are written in the function language.
"""

from collections.abc import Mapping

from clerestory.radiance.cal.library import Native
from clerestory.radiance.cal.luminaires import SOURCE
from clerestory.radiance.cal.skies import PEREZLUM, SKYBRIGHT
from clerestory.radiance.cal.syntax import Definition, parse_definitions

NATIVE_FILES: Mapping[str, Mapping[str, Native]] = {
    "skybright.cal": SKYBRIGHT,
    "perezlum.cal": PEREZLUM,
    "source.cal": SOURCE,
}

# Normal perturbation of a gensurf patch, bilinear in the two axes other than A1
_SURF = """
u = select(A1 + 1, Py, Pz, Px); v = select(A1 + 1, Pz, Px, Py);
bent(i) = u*v*arg(i) + u*arg(i + 3) + v*arg(i + 6) + arg(i + 9);
surf_dx = bent(2); surf_dy = bent(3); surf_dz = bent(4);
"""

# Surface of revolution around z: radial normal component A3 r + A4, axial A1 z + A2
_REV = """
r = sqrt(Px*Px + Py*Py); outwards = A3*r + A4;
rev_dx = outwards*Px/r; rev_dy = outwards*Py/r; rev_dz = A1*Pz + A2;
"""

# Triangle normal, interpolated by three linear functions of the two axes other than A1
_TMESH = """
p = select(A1 + 1, Py, Pz, Px); q = select(A1 + 1, Pz, Px, Py);
along(i) = p*arg(i) + q*arg(i + 1) + arg(i + 2);
v1 = along(2); v2 = along(5); v3 = along(8);
size = sqrt(v1*v1 + v2*v2 + v3*v3);
dx = v1/size - Nx; dy = v2/size - Ny; dz = v3/size - Nz;
u = frac(v1); v = frac(v2);
"""

TEXT_FILES: Mapping[str, Mapping[str, Definition]] = {
    "surf.cal": parse_definitions(_SURF),
    "rev.cal": parse_definitions(_REV),
    "tmesh.cal": parse_definitions(_TMESH),
}
