"""Reading of materials that hold others or a BSDF, and of those that shine."""

import numpy as np

from clerestory.radiance.arguments import Definition
from clerestory.radiance.function_pattern import constant_value, constant_vector
from clerestory.radiance.pattern_reader import read_share, read_vector
from clerestory.scene.composite import (
    BsdfSurface,
    Illum,
    Material,
    Mirror,
    Mixture,
    Void,
)
from clerestory.scene.emitter import Glow, Light, Spotlight
from clerestory.scene.transform import Transform


def mirror(made: Definition) -> Material:
    """Return a mirror, with the material that replaces it where it has one."""
    colour = made.share("reflectance", made.reals(3))
    alternate = _alternate(made)
    return Mirror(made.item.name, colour, alternate, made.source)


def mixture(made: Definition) -> Material:
    """Return a mixture of two materials, in shares that a pattern gives."""
    words = made.item.strings
    if len(words) < 4:
        raise made.error(
            f"{len(words)} string arguments; foreground, background, share and"
            " function file expected"
        )
    share = read_share(made, made.placed)
    constant = constant_value(share)
    return Mixture(
        made.item.name,
        made.named(words[0]),
        made.named(words[1]),
        share if constant is None else float(np.clip(constant[0], 0, 1)),
        made.source,
    )


def bsdf(made: Definition) -> Material:
    """Return a surface with a BSDF: BSDF with a thickness, or aBSDF without."""
    peak = made.item.kind == "aBSDF"
    first = 0 if peak else 1  # the thickness stands before the file
    words = made.item.strings
    if len(words) < first + 5:
        raise made.error(
            f"{len(words)} string arguments; {'' if peak else 'thickness, '}"
            "BSDF file, up vector, function file and transform expected"
        )
    value = made.share("added diffuse light", _padded(made))
    transform = made.oriented(first + 5)
    up = constant_vector(read_vector(made, Transform(), first + 1))
    if up is None:
        raise made.error("its up vector varies; one for all points expected")
    if not np.any(up):
        raise made.error("its up vector has no length")
    # In the coordinates before the transform
    up = up @ np.linalg.inv(made.transform(first + 5).matrix[:3, :3])
    return BsdfSurface(
        name=made.item.name,
        bsdf=made.bsdf(words[first]),
        thickness=0.0 if peak else made.constant("its thickness", 0) * transform.scale,
        up=made.direction(up),
        transform=transform.matrix[:3, :3] / transform.scale,
        front=value[:3],
        back=value[3:6],
        transmission=value[6:],
        peak=peak,
        source=made.source,
    )


def light(made: Definition) -> Material:
    """Return a lamp."""
    made.no_strings()
    return Light(made.item.name, made.radiance(made.reals(3)), made.source)


def glow(made: Definition) -> Material:
    """Return a surface that shines, with its reach in the scene's metres."""
    made.no_strings()
    value = made.reals(4)
    radius = float(value[3]) * made.placed.scale
    return Glow(made.item.name, made.radiance(value[:3]), radius, made.source)


def illum(made: Definition) -> Material:
    """Return a surface that lights like a lamp and looks like something else."""
    radiance = made.radiance(made.reals(3))
    return Illum(made.item.name, radiance, _alternate(made) or Void(), made.source)


def spotlight(made: Definition) -> Material:
    """Return a lamp with a cone."""
    made.no_strings()
    value = made.reals(7)
    if not 0 < value[3] <= 360:
        raise made.error(f"angle is {value[3]:g}°; more than 0 and up to 360 expected")
    towards = made.placed.vectors(value[4:])
    return Spotlight(
        made.item.name,
        made.radiance(value[:3]),
        float(value[3]),
        made.direction(towards),
        float(np.linalg.norm(towards)),
        made.source,
    )


def _alternate(made: Definition) -> Material | None:
    # The one material that may be named
    words = made.item.strings
    if len(words) > 1:
        raise made.error(f"{len(words)} string arguments; 0 or 1 expected")
    return made.named(words[0]) if words else None


def _padded(made: Definition) -> np.ndarray:
    # Front, back and transmission; what is not given adds nothing
    given = made.reals(0, 3, 6, 9)
    return np.concatenate([given, np.zeros(9 - len(given))])
