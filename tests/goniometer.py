"""A virtual goniophotometer: known layers, measured with noise, gaps and an aperture.

The layers are sums of lobes whose places, widths and fluxes are formulas of the
incident direction, so the truth is known at every pair of directions.
"""

from dataclasses import dataclass

import numpy as np

from clerestory.gonio.angles import from_degrees, undeviated
from clerestory.gonio.lobes import Lobes
from clerestory.gonio.scattering_measurement import Measurement, Scan


def film(incident):
    """Redirecting film: light goes on, or up again; both lobes sharp, on a veil."""
    x, y, z = incident
    on = undeviated(incident)
    back = np.array([-x, y, z])
    share = 0.5 + 0.35 * np.tanh(3 * y)  # light from above is redirected more
    fresnel = 1 - 0.9 * (1 - z) ** 5
    centre = np.array([on, back, [0, 0, 1.0]])
    radius = np.radians([3.0, 4.5, 50.0])
    flux = fresnel * np.array([0.7 * (1 - share), 0.7 * share, 0.08])
    return Lobes(centre, radius, flux)


def louvre(incident):
    """Microlouvre: light goes straight on within a cut-off, a little is scattered."""
    _, y, z = incident
    profile = np.abs(np.arctan2(y, z))
    open_share = np.maximum(1 - np.tan(np.minimum(profile, 1.3)) / np.tan(0.9), 0)
    on = undeviated(incident)
    centre = np.array([on, [0, 0, 1.0]])
    radius = np.radians([2.0, 40.0])
    return Lobes(centre, radius, np.array([0.75 * open_share + 1e-9, 0.06]))


def pane(incident):
    """Rough pane: one lobe about where light goes on, wider at grazing incidence."""
    z = incident[2]
    on = undeviated(incident)
    centre = np.array([on, [0, 0, 1.0]])
    radius = np.array([0.16 + 0.12 * (1 - z), 0.9])
    fresnel = 1 - (1 - z) ** 5
    return Lobes(centre, radius, fresnel * np.array([0.7, 0.12]))


def rings(*, azimuths_deg, step_deg=10.0, most_deg=80.0):
    """Incident directions: the normal, and rings about it at the given azimuths."""
    theta = np.arange(step_deg, most_deg + 1e-6, step_deg)
    t, p = np.meshgrid(theta, np.asarray(azimuths_deg, dtype=float), indexing="ij")
    return np.concatenate([[[0, 0, 1.0]], from_degrees(t.ravel(), p.ravel())])


def half_circle():
    """81 incident directions of a layer whose left and right are alike."""
    coarse = rings(azimuths_deg=np.linspace(-90, 90, 9))
    theta, phi = np.meshgrid([50.0, 60, 70, 80], [-11.25, 11.25], indexing="ij")
    return np.concatenate([coarse, from_degrees(theta.ravel(), phi.ravel())])


def quarter_circle():
    """81 incident directions of a layer that is alike in all four quarters."""
    return rings(azimuths_deg=np.linspace(0, 90, 10))


@dataclass(frozen=True)
class Goniophotometer:
    """How the virtual instrument measures.

    Attributes
    ----------
    points : directions over the hemisphere, as many again about the peaks
    noise : relative
    floor : noise that does not depend on the value [1/sr]
    aperture_deg : radius of the detector
    gap_deg : half the width of the arm that holds the sample on the right, which
        hides a sector beyond 30° from the normal; 0 for none
    reach_deg : no detector beyond this angle
    """

    points: int = 3000
    noise: float = 0.02
    floor: float = 2e-4
    aperture_deg: float = 0.3
    gap_deg: float = 4.0
    reach_deg: float = 87.0

    def scan(self, layer, incident, rng, source=None):
        truth = layer(incident)
        leaving = self.directions(truth)
        # A disc-shaped aperture widens a lobe by half its radius squared
        seen = Lobes(
            truth.centre,
            np.sqrt(truth.radius**2 + np.radians(self.aperture_deg) ** 2 / 4),
            truth.flux,
        )
        value = seen.evaluate(leaving)
        value = value * (1 + self.noise * rng.normal(size=len(value)))
        value += self.floor * rng.normal(size=len(value))
        return Scan(incident, leaving, value, source)

    def directions(self, truth):
        """Even over the hemisphere, denser about the peaks, with a shadow."""
        n = self.points
        # A spiral of equal areas, as a scanning arm would draw it
        k = np.arange(n) + 0.5
        z = 1 - k / n
        angle = np.pi * (1 + 5**0.5) * k
        flat = np.sqrt(1 - z * z)
        parts = [np.stack([flat * np.cos(angle), flat * np.sin(angle), z], axis=-1)]
        sharp = truth.radius < 0.3
        for centre, radius in zip(
            truth.centre[sharp], truth.radius[sharp], strict=True
        ):
            m = n // (2 * max(int(sharp.sum()), 1))
            spread = 4 * radius * np.sqrt((np.arange(m) + 0.5) / m)
            turn = np.pi * (1 + 5**0.5) * np.arange(m)
            u, v = _tangents(centre)
            near = (
                centre
                + spread[:, None] * np.cos(turn)[:, None] * u
                + spread[:, None] * np.sin(turn)[:, None] * v
            )
            parts.append(near / np.linalg.norm(near, axis=1, keepdims=True))
        leaving = np.concatenate(parts)
        leaving = leaving[leaving[:, 2] > np.cos(np.radians(self.reach_deg))]
        beside = np.arctan2(leaving[:, 1], leaving[:, 0])
        low = leaving[:, 2] < np.cos(np.radians(30))
        arm = low & (np.abs(beside) < np.radians(self.gap_deg))
        return leaving[~arm]

    def measure(self, layer, incidents, *, seed=1, function="transmission_front"):
        rng = np.random.default_rng(seed)
        scans = tuple(self.scan(layer, d, rng) for d in incidents)
        return Measurement(scans, function, name=layer.__name__)


def _tangents(centre):
    aside = np.array([1.0, 0, 0]) if abs(centre[0]) < 0.7 else np.array([0, 1.0, 0])
    u = np.cross(centre, aside)
    u /= np.linalg.norm(u)
    return u, np.cross(centre, u)


def write_pabopto(measurement, folder, *, leave_out=()):
    """Write scans as Mountain would, up at φ = 90°, light from θ > 90°."""
    reflected = measurement.function.startswith("reflection")
    files = []
    for k, scan in enumerate(measurement.scans):
        if k in leave_out:
            continue
        path = folder / f"scan_{k:03d}.txt"
        theta, phi = _degrees(scan.incident)
        lines = [
            f'#sample_name "{measurement.name}"',
            "#format: theta phi BTDF",
            f"#intheta {180 - theta:.4f}",
            f"#inphi {phi:.4f}",
            "#upphi 90",
        ]
        out_theta, out_phi = _degrees(scan.leaving)
        if reflected:
            out_theta = 180 - out_theta
        lines += [
            f"{t:.4f} {p:.4f} {v:.6g}"
            for t, p, v in zip(out_theta, out_phi, scan.values, strict=True)
        ]
        path.write_text("\n".join(lines) + "\n")
        files.append(path)
    return files


def _degrees(direction):
    x, y, z = np.moveaxis(direction, -1, 0)
    return np.degrees(np.arctan2(np.hypot(x, y), z)), np.degrees(np.arctan2(y, x))
