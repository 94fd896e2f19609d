"""Plugins of Radiance's materials: sampling, reciprocity, energy, exact angles."""

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from clerestory.engine import device as devices

# Mitsuba and Dr.Jit exist once a device was started
devices.load("cpu")

import drjit as dr
import mitsuba as mi

from clerestory.engine import materials
from clerestory.radiance.cal.program import Program
from clerestory.radiance.cal.syntax import parse_expression
from clerestory.radiance.function_pattern import FunctionPattern
from clerestory.scene.model import (
    Dielectric,
    Illum,
    Interface,
    Metal,
    Mirror,
    Mixture,
    Patterned,
    Plastic,
    Textured,
    Trans,
    Void,
)

WHITE = np.ones(3)
TINTED = np.array([0.6, 0.5, 0.4])
UP = np.array([0.3, 1.0, 0.2])
ELLIPSE = np.array([0.1, 0.35])


def function(*texts):
    """A pattern of expressions."""
    return FunctionPattern(Program(), tuple(parse_expression(t) for t in texts))


def sheets(colour):
    """Thin sheets that scatter, of a colour."""
    rough = Trans("", colour, 0.1, 0.2, 0.7, 0.6)
    matt = Plastic("", colour, 0.05, 0.1)
    bump = function(".3", "-.2", ".1")
    return {
        "metal": Metal("", colour, 0.8, 0.15),
        "smooth plastic": Plastic("", colour, 0.05, 0.0),
        "plastic2": Plastic("", colour, 0.2, ELLIPSE, up=UP),
        "metal2": Metal("", colour, 0.9, ELLIPSE[::-1], up=UP),
        "trans": rough,
        "smooth trans": Trans("", colour, 0.05, 0.0, 0.6, 0.5),
        "trans2": Trans("", colour, 0.1, ELLIPSE, 0.7, 0.6, up=UP),
        "mixture": Mixture("", Plastic("", colour, 0.3, 0.2), rough, 0.3),
        "perforated": Mixture("", rough, Void(), 0.4),
        "varying mixture": Mixture("", matt, rough, function(".2+.5*(1+Px)")),
        "patterned": Patterned("", matt, function("1", ".5+Px", ".2")),
        "bumpy plastic": Textured("", matt, bump),
        "bumpy trans": Textured("", rough, bump),
    }


SHEETS = sheets(TINTED)
# Radiance weakens the diffuse part of smooth coats by one of the two angles only
# and bent normals weigh the two directions by different cosines
RECIPROCAL = sorted(
    set(SHEETS) - {"smooth plastic", "smooth trans", "bumpy plastic", "bumpy trans"}
)


@pytest.fixture
def load(device):
    """Make a plugin of a material."""
    materials.register()
    return materials.load


def interaction(n, wi, *, distance=1.0):
    """Points of a surface that light leaves in a direction, in a turned frame."""
    si = dr.zeros(mi.SurfaceInteraction3f, n)
    si.sh_frame = mi.Frame3f(dr.normalize(mi.Vector3f(1, -2, 3)))
    si.n = si.sh_frame.n
    si.wi = mi.Vector3f(wi)
    si.t = distance
    return si


def leaving(tilt_deg, turn_deg=30.0):
    """Unit vector at an angle from the normal."""
    tilt, turn = np.radians([tilt_deg, turn_deg])
    sine = np.sin(tilt)
    return [float(sine * np.cos(turn)), float(sine * np.sin(turn)), float(np.cos(tilt))]


def numbers(n, seed):
    """Random numbers for n samples."""
    rng = np.random.default_rng(seed)
    first, *rest = rng.random((3, n), dtype="f4")
    return mi.Float(first), mi.Point2f(rest[0], rest[1])


@pytest.mark.parametrize(
    "tilt_deg", [pytest.param(15, marks=pytest.mark.slow), 65, 130]
)
@pytest.mark.parametrize("name", SHEETS)
def test_sheets_sample_their_own_density(load, name, tilt_deg):
    """Mitsuba's chi² test, from the front and from the back."""
    from mitsuba import chi2

    bsdf, context, wi = load(SHEETS[name]), mi.BSDFContext(), leaving(tilt_deg)

    def sample(u):
        si = interaction(dr.width(u), wi)
        bs, weight = bsdf.sample(context, si, u.x, mi.Point2f(u.y, u.z))
        scattered = ~mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
        alive = dr.any(weight > 0) & scattered
        return bs.wo, dr.select(alive, mi.Float(1), mi.Float(0))

    test = chi2.ChiSquareTest(
        domain=chi2.SphericalDomain(),
        sample_func=sample,
        pdf_func=lambda wo: bsdf.pdf(context, interaction(dr.width(wo), wi), wo),
        sample_dim=3,
        sample_count=200_000,
        res=51,
        ires=16,  # lobes are narrow: the density must be integrated well
    )
    assert test.run(0.01, len(SHEETS) * 3), test.messages


@pytest.mark.parametrize("tilt_deg", [65])
@pytest.mark.parametrize("name", SHEETS)
def test_weights_of_samples_are_value_over_density(load, name, tilt_deg):
    """The mean weight of scattered samples is the integral of the value."""
    bsdf, context = load(SHEETS[name]), mi.BSDFContext()
    n, wi = 400_000, leaving(tilt_deg)
    si = interaction(n, wi)
    bs, weight = bsdf.sample(context, si, *numbers(n, 1))
    peak = mi.has_flag(bs.sampled_type, mi.BSDFFlags.Delta)
    sampled = dr.select(peak, 0, weight).numpy()

    # The same integral with directions that know nothing of the material
    wo = mi.warp.square_to_uniform_sphere(numbers(n, 2)[1])
    even = bsdf.eval(context, si, wo).numpy() * 4 * np.pi
    error = np.sqrt((sampled.var(axis=1) + even.var(axis=1)) / n)
    assert np.all(error < 0.01)
    assert np.all(np.abs(sampled.mean(axis=1) - even.mean(axis=1)) < 4 * error)


@pytest.mark.parametrize("name", RECIPROCAL)
def test_sheets_are_reciprocal(load, name):
    """f(a, b) = f(b, a) over the whole sphere."""
    bsdf, context, n = load(SHEETS[name]), mi.BSDFContext(), 5000
    rng = np.random.default_rng(3)
    a, b = (stats.uniform_direction(3, seed=rng).rvs(n) for _ in range(2))
    # Radiance holds cosines below 0.001 at it
    kept = (np.abs(a[:, 2]) > 0.002) & (np.abs(b[:, 2]) > 0.002)

    def value(i, o):
        si = interaction(n, i.T.astype("f4"))
        f = bsdf.eval(context, si, mi.Vector3f(o.T.astype("f4")))
        return (f.numpy() / np.abs(o[:, 2]))[:, kept]

    assert value(a, b) == pytest.approx(value(b, a), rel=3e-3, abs=1e-5)


@pytest.mark.parametrize("tilt_deg", [5, 120])
@pytest.mark.parametrize("name", SHEETS)
def test_white_sheets_make_no_light(load, name, tilt_deg):
    """White furnace: only what a lobe sends below the surface is lost."""
    n = 200_000
    bsdf = load(sheets(WHITE)[name])
    si = interaction(n, leaving(tilt_deg))
    _, weight = bsdf.sample(mi.BSDFContext(), si, *numbers(n, 4))
    weight = weight.numpy()[0]
    error = weight.std() / np.sqrt(n)
    assert error < 2e-3
    assert weight.mean() < 1 + 4 * error + 1e-5
    if name.startswith("smooth"):
        assert weight.mean() > 1 - 4 * error - 1e-5


def test_trans_divides_light_as_radiance_says(load):
    """0.9·0.6 pass at 10 % highlight; 40 % of them straight on, the rest diffused."""
    made = load(Trans("", TINTED, 0.01, 0.0, 0.6, 0.4))
    n = 400_000
    bs, weight = made.sample(
        mi.BSDFContext(), interaction(n, leaving(30)), *numbers(n, 5)
    )
    kind, weight = bs.sampled_type.numpy(), weight.numpy()
    flags = mi.BSDFFlags
    for flag, share in (
        (flags.Null, 0.99 * 0.6 * 0.4 * TINTED),
        (flags.DiffuseTransmission, 0.99 * 0.6 * 0.6 * TINTED),
        (flags.DiffuseReflection, 0.99 * 0.4 * TINTED),
        (flags.DeltaReflection, 0.01 * WHITE),
    ):
        of_kind = np.where(kind == +flag, weight, 0)
        error = of_kind.std(axis=1) / np.sqrt(n)
        assert np.all(np.abs(of_kind.mean(axis=1) - share) < 4 * error)
    straight = made.eval_null_transmission(interaction(1, leaving(30)))
    assert straight.numpy().ravel() == pytest.approx(0.99 * 0.24 * TINTED)


@pytest.mark.parametrize("name", ["metal2", "plastic2", "trans2"])
def test_highlights_are_wide_where_the_facets_are_rough(load, name):
    """Seen from above, half vectors spread by the two roughnesses along `up`.

    The sheet has nothing else than a highlight, so that all directions are its.
    """
    n = 100_000
    made = load(replace(SHEETS[name], specularity=1.0))
    si = interaction(n, [0.0, 0.0, 1.0])
    bs, weight = made.sample(mi.BSDFContext(), si, *numbers(n, 6))
    glossy = mi.has_flag(bs.sampled_type, mi.BSDFFlags.GlossyReflection)
    kept = (glossy & dr.any(weight > 0)).numpy()
    local_up = si.to_local(mi.Vector3f(UP)).numpy()[:2, 0]
    axis = local_up / np.linalg.norm(local_up)
    half = bs.wo.numpy() + np.array([[0], [0], [1]])
    slope = (half[:2] / half[2])[:, kept]
    along, across = axis @ slope, axis[0] * slope[1] - axis[1] * slope[0]
    expected = SHEETS[name].roughness / np.sqrt(2)
    found = np.array([along.std(), across.std()])
    # The longest slopes would go below the surface
    assert found == pytest.approx(expected, rel=0.02)


@pytest.mark.parametrize("tilt_deg", [0, 40, 75])
@pytest.mark.parametrize("name", ["metal2", "plastic2"])
def test_directions_count_as_diffuse_as_often_as_matt_light_takes_them(
    load, name, tilt_deg
):
    """Their light is that of Lambert's law, whichever part proposed them."""
    n, sheet = 200_000, SHEETS[name]
    si = interaction(n, leaving(tilt_deg))
    bs, weight = load(sheet).sample(mi.BSDFContext(), si, *numbers(n, 8))
    matt = mi.has_flag(bs.sampled_type, mi.BSDFFlags.DiffuseReflection)
    light = dr.mean(dr.select(matt, weight, 0)).numpy()
    expected = (1 - sheet.specularity) * np.mean(sheet.reflectance)
    assert abs(light.mean() - expected) < 4 * light.std() / n**0.5
    assert light.std() / n**0.5 < 0.01 * expected


def test_an_up_vector_along_the_normal_makes_an_isotropic_highlight(load):
    """Radiance then takes the mean of the squared roughnesses."""
    si = interaction(64, leaving(30))
    normal = si.sh_frame.n.numpy().ravel()
    both = [
        load(Plastic("", TINTED, 0.2, np.array([0.1, 0.3]), up=normal)),
        load(Plastic("", TINTED, 0.2, np.sqrt((0.01 + 0.09) / 2))),
    ]
    wo = mi.warp.square_to_cosine_hemisphere(numbers(64, 7)[1])
    one, other = (b.eval(mi.BSDFContext(), si, wo).numpy() for b in both)
    assert one == pytest.approx(other, rel=1e-4)


@pytest.mark.parametrize("tilt_deg", [0, 40, 89])
def test_a_dielectric_follows_snell_and_fresnel(load, tilt_deg):
    """From air into index 1.5 and back, with absorption over 0.5 m inside."""
    made = load(Dielectric("", np.array([0.25, 1.0, 0.0]), 1.5))
    wi = np.array(leaving(tilt_deg, 0))
    cos_in, cos_out = wi[2], np.sqrt(1 - (wi[0] / 1.5) ** 2)
    across = (cos_in - 1.5 * cos_out) / (cos_in + 1.5 * cos_out)
    along = (1.5 * cos_in - cos_out) / (1.5 * cos_in + cos_out)
    reflectance = (across**2 + along**2) / 2

    si = interaction(1, wi.tolist(), distance=0.5)
    bs, weight = made.sample(mi.BSDFContext(), si, 0.0, mi.Point2f(0.5, 0.5))
    assert bs.pdf.numpy()[0] == pytest.approx(reflectance, rel=1e-4)
    assert weight.numpy()[0] == pytest.approx(1)
    bs, weight = made.sample(mi.BSDFContext(), si, 0.9999, mi.Point2f(0.5, 0.5))
    bent = bs.wo.numpy().ravel()
    assert bent == pytest.approx([-wi[0] / 1.5, 0, -cos_out], abs=1e-6)
    assert weight.numpy().ravel() == pytest.approx(1 / 1.5**2)

    # The way back: the same angles, and what is left after half a metre
    si = interaction(1, bent.tolist(), distance=0.5)
    bs, weight = made.sample(mi.BSDFContext(), si, 0.9999, mi.Point2f(0.5, 0.5))
    assert bs.wo.numpy().ravel() == pytest.approx(wi, abs=2e-5)
    assert bs.pdf.numpy()[0] == pytest.approx(1 - reflectance, rel=1e-3)
    assert weight.numpy().ravel() == pytest.approx(
        [0.5 * 1.5**2, 1.5**2, 0], rel=1e-4, abs=1e-12
    )


def test_light_is_totally_reflected_beyond_the_critical_angle(load):
    """arcsin(1.33 / 1.5) = 62.5° from the denser side of an interface."""
    made = load(Interface("", WHITE, 1.5, WHITE, 1.33))
    for tilt_deg, total in ((60, False), (65, True)):
        si = interaction(1, leaving(180 - tilt_deg))
        bs, _ = made.sample(mi.BSDFContext(), si, 0.9999999, mi.Point2f(0.5, 0.5))
        reflected = mi.has_flag(bs.sampled_type, mi.BSDFFlags.DeltaReflection)
        assert bool(reflected.numpy()[0]) is total


def test_a_mirror_is_black_behind(load):
    made = load(Mirror("", TINTED))
    for tilt_deg, colour in ((30, TINTED), (150, 0 * TINTED)):
        wi = leaving(tilt_deg)
        bs, weight = made.sample(
            mi.BSDFContext(), interaction(1, wi), 0.5, mi.Point2f(0.5, 0.5)
        )
        assert weight.numpy().ravel() == pytest.approx(colour)
    assert bs.wo.numpy().ravel() == pytest.approx([-wi[0], -wi[1], wi[2]])


def test_what_is_replaced_acts_as_its_alternate(device):
    grey = Plastic("", TINTED)
    assert Mirror("", WHITE, grey).plugin() == grey.plugin()
    assert Illum("", WHITE, grey).plugin() == grey.plugin()
    assert Illum("", WHITE).plugin().name == "null"


def test_a_perforated_sheet_passes_light_through_its_holes(load):
    """40 % sheet: 60 % of the light passes straight on."""
    made = load(Mixture("", Plastic("", TINTED), Void(), 0.4))
    straight = made.eval_null_transmission(interaction(1, leaving(50)))
    assert straight.numpy().ravel() == pytest.approx([0.6] * 3)


def test_plugins_take_numbers_and_colours_as_mitsuba_writes_them(load):
    """Anyone's scene may say `rgb`."""
    made = mi.load_dict(
        {
            "type": "radiance_plastic",
            "reflectance": {"type": "rgb", "value": [0.3, 0.2, 0.1]},
        }
    )
    value = made.eval(
        mi.BSDFContext(), interaction(1, leaving(0)), mi.Vector3f(0, 0, 1)
    )
    assert value.numpy().ravel() == pytest.approx(np.array([0.3, 0.2, 0.1]) / np.pi)


def test_reflectances_above_one_are_taken_as_they_are(load):
    """The reader warns; Mitsuba's own colours would refuse them."""
    made = load(Plastic("", np.array([1.5, 1.0, 0.5])))
    value = made.eval(
        mi.BSDFContext(), interaction(1, leaving(0)), mi.Vector3f(0, 0, 1)
    )
    assert value.numpy().ravel() == pytest.approx(np.array([1.5, 1.0, 0.5]) / np.pi)
