"""Light sources that are sampled by next-event estimation."""

from clerestory.scene.model import DistantSource, Emitter, Glow, Scene

# Distant sources up to this opening angle [°] are sampled, as discs with sharp edges;
# the same for sources with a pattern, of which only the value at the centre is used.
_DISC_DEG, _PATTERNED_DEG = 60.0, 12.0


def suns_of(scene: Scene) -> list[DistantSource]:
    """Return the distant sources that are sampled directly, like the sun."""
    return [each for each in scene.distant if _is_sun(each, scene)]


def _is_sun(source: DistantSource, scene: Scene) -> bool:
    even = scene.materials[source.material].pattern is None
    return source.angle_deg <= (_DISC_DEG if even else _PATTERNED_DEG)


def is_sampled(material: Emitter) -> bool:
    """Whether an emitter is sampled by next-event estimation."""
    return not (isinstance(material, Glow) and material.radius <= 0)
