"""A room whose luminance is a function of direction and time, with its own sun.

The eye stands in a box with a window in the wall towards +y. Outside: a sky with a
gradient, brighter about the sun, over bright ground; inside: walls darker with distance
from the window, and the sun's patches. The sun's disc is 2° wide, so that pixels
resolve it.
"""

from dataclasses import dataclass, replace

import numpy as np

from clerestory.glare.eye_directions import SunDisc

SIZE = np.array([4.0, 6.0, 2.8])
EYE = np.array([1.6, 3.8, 1.2])
SILL, HEAD, LEFT, RIGHT = 0.9, 2.75, 0.5, 3.5
PITCH, SLAT = 0.06, 0.55  # of slats [m], and the share of the pitch that one hides
GLASS = 0.7
RADIUS = np.radians(1.0)
DISC = 2 * np.pi * (1 - np.cos(RADIUS))


@dataclass(frozen=True)
class AnalyticRoom:
    """Luminances of `kind` "window", "slats" or "sky" under suns and skies."""

    kind: str
    sun: np.ndarray
    normal: np.ndarray  # direct normal illuminance [lux]
    diffuse: np.ndarray  # diffuse horizontal illuminance [lux]

    def at(self, steps):
        parts = (self.sun[steps], self.normal[steps], self.diffuse[steps])
        return replace(
            self, **dict(zip(("sun", "normal", "diffuse"), parts, strict=True))
        )

    def luminance(self, direction):
        """Luminance (direction, step) without the sun's disc [cd/m²]."""
        sky = self._sky(direction)
        if self.kind == "sky":
            return sky
        inside = self._room(direction)
        window, slat = self._through(direction)
        slats = 0.04 * self.diffuse + 0.016 * self.normal * self._facing()
        seen = np.where(slat[:, None], slats, GLASS * sky)
        return np.where(window[:, None], seen, inside)

    def of_samples(self, samples):
        """Luminance of the directions of samples; see `luminance`."""
        return self.luminance(samples.direction)

    def disc(self):
        """The sun's disc, whole where the line to its centre is free."""
        glass = 1.0 if self.kind == "sky" else GLASS
        visible = self.opens(self.sun) & (self.normal > 0)
        return SunDisc(self.sun, glass * self.normal / DISC, DISC * visible)

    def opens(self, direction):
        """Whether the sky is seen, through the window and between its slats."""
        if self.kind == "sky":
            return direction[:, 2] > 0
        window, slat = self._through(direction)
        return window & ~slat

    def picture(self, direction):
        """Luminance (direction, step) with the sun's disc [cd/m²]."""
        sun = self.disc()
        inside = (direction @ self.sun.T > np.cos(RADIUS)) & (sun.solid_angle > 0)
        return np.where(inside, sun.luminance, self.luminance(direction))

    def is_whole(self, view):
        """Whether no disc is cut by the rim of a hemispherical view, by step."""
        return np.abs(self.sun @ view.direction) > np.sin(RADIUS)

    def _facing(self):
        return np.maximum(self.sun[:, 1], 0)

    def _sky(self, direction):
        up = direction[:, 2:3]
        cosine = np.clip(direction @ self.sun.T, -1, 1)
        glow = 0.12 * self.normal * np.exp(-np.arccos(cosine) / np.radians(12))
        overcast = self.diffuse * (1 + 2 * np.maximum(up, 0)) / (7 * np.pi / 3)
        ground = (self.diffuse + self.normal * self.sun[:, 2]) * 0.2 / np.pi
        return np.where(up > 0, overcast + glow, ground)

    def _through(self, direction, eye=EYE):
        ahead = direction[:, 1] > 1e-9
        far = (SIZE[1] - eye[..., 1]) / np.where(ahead, direction[:, 1], 1)
        x, z = (eye[..., k] + far * direction[:, k] for k in (0, 2))
        window = ahead & (x > LEFT) & (x < RIGHT) & (z > SILL) & (z < HEAD)
        return window, (self.kind == "slats") & ((z / PITCH) % 1 < SLAT)

    def _room(self, direction):
        with np.errstate(divide="ignore"):
            to_walls = np.where(direction > 0, SIZE - EYE, EYE) / np.abs(direction)
        wall = to_walls.argmin(axis=1)
        point = EYE + to_walls.min(axis=1)[:, None] * direction
        flat = np.where(direction[:, 2] > 0, 0.8, 0.25)
        grey = np.where(wall == 2, flat, 0.5)[:, None] / np.pi
        fall = 0.25 + 1.5 * np.exp((point[:, 1:2] - SIZE[1]) / 1.5)
        diffuse = 0.04 * (self.diffuse + 0.25 * self.normal * self._facing()) * fall
        inwards = -np.sign(np.take_along_axis(direction, wall[:, None], 1))
        patches = np.zeros(diffuse.shape)
        for step, (sun, normal) in enumerate(zip(self.sun, self.normal, strict=True)):
            window, slat = self._through(np.broadcast_to(sun, point.shape), point)
            cosine = np.maximum(inwards[:, 0] * sun[wall], 0)
            patches[:, step] = GLASS * normal * cosine * (window & ~slat)
        return grey * (diffuse + patches)


def analytic_room(kind, *, steps=24, seed=5):
    """Suns of a year towards the window, a third of them behind clouds."""
    random = np.random.default_rng(seed)
    altitude = np.radians(random.uniform(4, 55, steps))
    azimuth = np.radians(random.uniform(-70, 70, steps))
    flat = np.cos(altitude)
    sun = np.stack(
        [flat * np.sin(azimuth), flat * np.cos(azimuth), np.sin(altitude)], 1
    )
    normal = 1e5 * np.sin(altitude) ** 0.3 * random.random(steps)
    normal *= random.random(steps) > 0.35
    diffuse = (8e3 + 22e3 * random.random(steps)) * np.sin(altitude) + 500
    return AnalyticRoom(kind, sun, normal, diffuse)
