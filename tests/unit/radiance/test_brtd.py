"""BRTDfunc, and what is said of the types of Radiance that are not supported."""

import re

import numpy as np
import pytest

from clerestory.errors import InputError
from clerestory.radiance.instance import INSTANCE_KINDS
from clerestory.radiance.pattern_reader import PATTERN_KINDS
from clerestory.radiance.primitives import SURFACES
from clerestory.radiance.rad_reader import read_rad
from clerestory.radiance.rad_writer import format_rad
from clerestory.scene.materials import INSTEAD, READERS

# All types of Radiance 6.1 (src/common/otypes.h), without alias
TYPES = re.findall(
    r"\w+",
    """
polygon cone sphere texfunc ring cylinder instance cup bubble tube mesh plastic metal
glass trans dielectric plastic2 metal2 trans2 interface plasfunc metfunc brightfunc
brightdata brighttext colorpict glow source light illum spotlight mist mirror transfunc
BRTDfunc BSDF aBSDF plasdata metdata transdata colorfunc antimatter colordata colortext
texdata mixfunc mixdata mixtext mixpict prism1 prism2 ashik2 WGMDfunc
spectrum specfile specfunc specdata specpict
""",
)
SHEET = "x polygon p 0 0 12 0 0 0 1 0 0 1 1 0 0 1 0\n"
LOW_E = (
    "void BRTDfunc x 10 r(.1) r(.2) r(.3) t(arg(10)) t(arg(11)) .5 0 0 0 fresnel.cal"
    " 0 11 .1 .1 .1 .2 .2 .2 0 0 0 .6 .7\n"
)


@pytest.fixture
def scene(tmp_path):
    """Read a scene beside a function file with r and t."""
    (tmp_path / "fresnel.cal").write_text(
        "f = exp(-5.85*abs(Rdot));\nr(a) = a + f*(1-a);\nt(a) = a*(1-f);\n"
    )

    def read(text):
        (tmp_path / "main.rad").write_text(text)
        return read_rad(tmp_path / "main.rad")

    return read


@pytest.mark.parametrize("kind", TYPES)
def test_each_type_is_read_or_refused_with_what_to_use(scene, kind):
    read = {*READERS, *PATTERN_KINDS, *SURFACES, *INSTANCE_KINDS, "polygon"}
    assert (kind in read) != (kind in INSTEAD)
    if kind in read:
        return
    with pytest.raises(InputError, match=rf'main\.rad:1: {kind} "x": ') as caught:
        scene(f"void {kind} x 0 0 0\n{SHEET}")
    message = str(caught.value)
    assert message.endswith(" expected")
    assert INSTEAD[kind] in message
    assert len(message.splitlines()) == 1
    assert len(message) < 500


def test_nothing_is_refused_that_is_no_type():
    assert set(INSTEAD) <= set(TYPES)


def test_coefficients_depend_on_the_angle(scene):
    """r + f (1 - r) with f = exp(-5.85 cos)."""
    sheet = scene(LOW_E + SHEET).materials["x"]
    cosine = np.array([1.0, 0.5, 0.1])
    towards = np.stack([np.sqrt(1 - cosine**2), 0 * cosine, cosine], axis=1)
    normal = np.broadcast_to([0.0, 0.0, 1.0], (3, 3))
    f = np.exp(-5.85 * cosine)[:, None]
    r, t = np.array([0.1, 0.2, 0.3]), np.array([0.6, 0.7, 0.5])
    reflected = sheet.reflection.value(towards, normal, np.zeros((3, 3)))
    passed = sheet.transmission.value(towards, normal, np.zeros((3, 3)))
    assert reflected == pytest.approx(r + f * (1 - r))
    assert passed[:, :2] == pytest.approx((t * (1 - f))[:, :2])
    assert np.all(passed[:, 2] == 0.5)
    assert sheet.back.tolist() == [0.2, 0.2, 0.2]
    assert not sheet.opaque


def test_it_is_written_as_it_was_read(scene):
    given = scene(LOW_E + SHEET)
    again = scene(format_rad(given, bsdf_file={}))
    one, other = (each.materials["x"] for each in (given, again))
    assert one.strings == other.strings
    assert one.reals == other.reals


REFUSED = {
    "few strings": ("void BRTDfunc x 3 1 1 1 0 0", "3 string arguments"),
    "few numbers": ("void BRTDfunc x 10 1 1 1 0 0 0 0 0 0 . 0 1 1", "1 numbers; 9 or"),
    "a BRTD": (
        "void BRTDfunc x 10 0 0 0 0 0 0 .1 .1 .1 . 0 9 0 0 0 0 0 0 0 0 0",
        "the BRTD functions are not zero; 0 0 0, or a BSDF file",
    ),
    "unknown name": (
        "void BRTDfunc x 10 no 0 0 0 0 0 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
        '"no" is not defined',
    ),
    "perturbed": (
        "void BRTDfunc x 10 RdotP 0 0 0 0 0 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
        '"RdotP" is used; Rdot expected',
    ),
    "missing argument": (
        "void BRTDfunc x 10 arg(12) 0 0 0 0 0 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
        "real argument 12 is used",
    ),
    "negative": (
        "void BRTDfunc x 10 0 0 0 0 0 0 0 0 0 . 0 9 -1 0 0 0 0 0 0 0 0",
        "a diffuse coefficient",
    ),
}


@pytest.mark.parametrize("case", REFUSED)
def test_what_cannot_be_is_refused(scene, case):
    text, message = REFUSED[case]
    with pytest.raises(InputError) as caught:
        scene(f"{text}\n{SHEET}")
    assert message in str(caught.value)
