"""The plugin of BSDF files: values, densities and samples against `Bsdf` itself."""

import numpy as np
import pytest
from scipy.stats import chi2

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.resample import tree_from
from clerestory.bsdf.scattering_function import FUNCTIONS
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.engine import device as devices
from clerestory.hemisphere.klems import klems
from clerestory.scene.model import BsdfSurface

UP = np.array([0.0, 1.0, 0.0])


def lopsided(seed=1):
    """Random matrices for all four functions: no symmetry, no reciprocity."""
    rng = np.random.default_rng(seed)
    patches = klems("quarter")
    size = len(patches)
    return Bsdf(
        {
            ("visible", name): ScatteringMatrix(
                rng.gamma(0.3, 0.2, (size, size)), patches, patches
            )
            for name in FUNCTIONS
        }
    )


def tree_of(bsdf):
    return Bsdf({key: tree_from(part, 4) for key, part in bsdf.functions.items()})


def layer(kind, shared_data):
    match kind:
        case "matrix":
            return lopsided()
        case "tree of rank 4":
            return tree_of(lopsided())
        case "tree of rank 3":
            return read_bsdf(shared_data / "tutorial_room" / "blinds" / "blindsT3.xml")


KINDS = ["matrix", "tree of rank 4", "tree of rank 3"]
SEEN_FROM = [(0.3, 0.2, 0.9), (-0.5, 0.6, -0.4), (0.05, -0.9, 0.3)]


@pytest.fixture
def mitsuba(device):
    """Mitsuba on a device, with the functions to ask a plugin."""
    devices.load(device)
    return pytest.importorskip("mitsuba")


class Asked:
    """A plugin in its own frame: normal +z, up +y."""

    def __init__(self, mi, bsdf, **options):
        import drjit as dr

        from clerestory.engine import materials

        self.mi, self.dr = mi, dr
        black = {name: np.zeros(3) for name in ("front", "back", "transmission")}
        surface = BsdfSurface("layer", bsdf, 0.0, UP, **(black | options))
        materials.register()
        self.plugin = materials.load(surface)

    def hit(self, seen_from, count):
        """Interaction seen from a direction."""
        mi = self.mi
        si = self.dr.zeros(mi.SurfaceInteraction3f, count)
        si.n = mi.Normal3f(0, 0, 1)
        si.sh_frame = mi.Frame3f(
            mi.Vector3f(1, 0, 0), mi.Vector3f(0, 1, 0), mi.Vector3f(0, 0, 1)
        )
        si.wi = mi.Vector3f(*[mi.Float(c.astype(np.float32)) for c in seen_from.T])
        return si

    def evaluate(self, seen_from, towards):
        """Green value × cosine and pdf for pairs."""
        mi = self.mi
        si = self.hit(np.broadcast_to(seen_from, towards.shape), len(towards))
        wo = mi.Vector3f(*[mi.Float(c.astype(np.float32)) for c in towards.T])
        value, pdf = self.plugin.eval_pdf(mi.BSDFContext(), si, wo)
        return value.numpy()[1], pdf.numpy()

    def sample(self, seen_from, count, seed=0):
        """Directions, green weights and pdfs of samples."""
        mi = self.mi
        u = np.random.default_rng(seed).random((3, count)).astype(np.float32)
        si = self.hit(np.broadcast_to(seen_from, (count, 3)), count)
        bs, weight = self.plugin.sample(
            mi.BSDFContext(), si, mi.Float(u[0]), mi.Point2f(u[1], u[2])
        )
        return bs.wo.numpy().T, weight.numpy()[1], bs.pdf.numpy()


def unit(direction):
    return np.array(direction) / np.linalg.norm(direction)


def sphere(count, seed):
    draws = np.random.default_rng(seed).normal(size=(count, 3))
    return draws / np.linalg.norm(draws, axis=1, keepdims=True)


@pytest.mark.parametrize("kind", KINDS)
def test_values_are_those_of_the_file(mitsuba, kind, shared_data):
    """Light from `towards` leaves to where it is seen from."""
    bsdf = layer(kind, shared_data)
    asked = Asked(mitsuba, bsdf)
    for seed, seen in enumerate(SEEN_FROM):
        towards = sphere(20000, seed)
        found, _ = asked.evaluate(unit(seen), towards)
        expected = bsdf.evaluate(towards, unit(seen)) * abs(towards[:, 2])
        # Float32 puts a few directions on the other side of a cell's edge
        apart = abs(found - expected) > 1e-4 * expected.max()
        assert apart.mean() < 1e-3


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seen", SEEN_FROM)
def test_samples_follow_their_density(mitsuba, kind, seen, shared_data):
    """A chi² test over cells of equal projected solid angle, on both sides."""
    asked = Asked(mitsuba, layer(kind, shared_data))
    count = 100_000
    towards, _, pdf = asked.sample(unit(seen), count)
    drawn = pdf > 0

    def cell(direction):
        radius2 = (direction[:, :2] ** 2).sum(axis=1)
        ring = np.minimum((radius2 * 8).astype(int), 7)
        turn = np.arctan2(direction[:, 1], direction[:, 0]) / (2 * np.pi) % 1
        side = direction[:, 2] > 0
        return (ring * 16 + np.minimum((turn * 16).astype(int), 15)) * 2 + side

    observed = np.bincount(cell(towards[drawn]), minlength=256)
    uniform = sphere(400_000, 9)
    _, density = asked.evaluate(unit(seen), uniform)
    share = np.bincount(cell(uniform), density, minlength=256) * 4 * np.pi
    expected = share / len(uniform) * count
    squares = np.bincount(cell(uniform), density**2, minlength=256)
    noise = squares * (4 * np.pi * count / len(uniform)) ** 2
    used = expected > 50
    terms = (observed - expected)[used] ** 2 / (expected + noise)[used]
    assert terms.sum() < chi2.ppf(1 - 1e-4, used.sum())
    assert expected.sum() == pytest.approx(drawn.sum(), rel=0.03)


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("seen", SEEN_FROM)
def test_weights_average_to_the_light_gathered(mitsuba, kind, seen, shared_data):
    asked = Asked(mitsuba, layer(kind, shared_data))
    _, weight, _ = asked.sample(unit(seen), 100_000)
    uniform = sphere(300_000, 3)
    value, _ = asked.evaluate(unit(seen), uniform)
    expected = value.mean() * 4 * np.pi
    error = np.hypot(
        weight.std() / len(weight) ** 0.5, value.std() * 4 * np.pi / len(value) ** 0.5
    )
    assert abs(weight.mean() - expected) < 4 * error
    # Proposals follow the data: no sample counts many times the mean
    assert weight.max() < 100 * weight.mean()


def test_added_diffuse_parts_count_on_their_sides(mitsuba):
    """Radiance's 9 numbers: reflection of front and back, transmission."""
    patches = klems("quarter")
    nothing = ScatteringMatrix(
        np.full((len(patches), len(patches)), 1e-9), patches, patches
    )
    bsdf = Bsdf({("visible", "transmission_front"): nothing})
    shares = {"front": 0.2, "back": 0.4, "transmission": 0.3}
    asked = Asked(mitsuba, bsdf, **{k: np.full(3, v) for k, v in shares.items()})
    out, back = np.array([[0, 0, 1.0]]), np.array([[0, 0, -1.0]])
    for seen, towards, share in (
        (out, out, 0.2),
        (back, back, 0.4),
        (out, back, 0.3),
        (back, out, 0.3),
    ):
        value, _ = asked.evaluate(seen, towards)
        assert value[0] == pytest.approx(share / np.pi, rel=1e-5)


def test_peak_of_clear_air_passes_straight(mitsuba):
    """aBSDF: 0.6 straight on over 0.2 diffused; the data keep the diffuse part."""
    patches = klems("full")
    straight = np.diag(0.6 / patches.projected_solid_angles())
    bsdf = Bsdf(
        {
            ("visible", "transmission_front"): ScatteringMatrix(
                straight + 0.2 / np.pi, patches, patches
            )
        }
    )
    asked = Asked(mitsuba, bsdf, peak=True)
    for seen in ((0.02, 0.01, 1.0), (0.5, -0.3, 0.8), (-0.6, 0.2, -0.7)):
        wi = unit(seen)[None]
        si = asked.hit(wi, 1)
        passed = asked.plugin.eval_null_transmission(si).numpy()[1, 0]
        assert passed == pytest.approx(0.6, abs=0.005)
        value, _ = asked.evaluate(wi, -wi)
        assert value[0] / abs(wi[0, 2]) == pytest.approx(0.2 / np.pi, rel=0.02)
        _, weight, _ = asked.sample(wi[0], 100_000)
        assert weight.mean() == pytest.approx(0.8, abs=0.005)


def test_a_surface_whose_normal_is_up_is_black(mitsuba):
    """Radiance's "illegal orientation vector": no light, and no NaN."""
    asked = Asked(mitsuba, lopsided())
    asked.plugin.up = asked.mi.Vector3f(0, 0, 1)
    value, pdf = asked.evaluate(unit((0.3, 0.2, 0.9)), sphere(1000, 1))
    assert np.all(value == 0)
    assert np.all(pdf == 0)
    _, weight, _ = asked.sample(unit((0.3, 0.2, 0.9)), 1000)
    assert np.all(weight == 0)
