"""Light sources that are sampled by next-event estimation."""

from clerestory.scene.model import DistantSource, Emitter, Glow

# Distant sources up to this opening angle [°] are sampled, as discs with sharp edges.
_DISC_DEG = 12.0


def is_sun(source: DistantSource) -> bool:
    """Whether a distant source has a small opening angle and is sampled directly."""
    return source.angle_deg <= _DISC_DEG


def is_sampled(material: Emitter) -> bool:
    """Whether an emitter is sampled by next-event estimation."""
    return not (isinstance(material, Glow) and material.radius <= 0)
