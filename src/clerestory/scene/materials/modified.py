"""Materials modified by a pattern (colour) or a texture (surface normal)."""

from dataclasses import dataclass

from clerestory.scene.material import Material, Plugin, Source
from clerestory.scene.pattern import Pattern


@dataclass(frozen=True, eq=False)
class Patterned(Material):
    """A material whose colour is multiplied by a pattern.

    Attributes
    ----------
    base : plastic, metal, trans, glass or mirror; for glass the transmission varies
    pattern : multiplier of the colour
    """

    name: str
    base: Material
    pattern: Pattern
    source: Source | None = None

    @property
    def opaque(self) -> bool:
        return self.base.opaque

    def plugin(self) -> Plugin:
        base = self.base.plugin()
        return Plugin(base.name, {**base.parameters, "pattern": self.pattern})

    def specification(self) -> None:
        return None


@dataclass(frozen=True, eq=False)
class Textured(Material):
    """A material whose surface normal is perturbed.

    Attributes
    ----------
    texture : vector added to the unit normal, in the coordinates of the function
    """

    name: str
    base: Material
    texture: Pattern
    source: Source | None = None

    @property
    def opaque(self) -> bool:
        return self.base.opaque

    def plugin(self) -> Plugin:
        return Plugin("radiance_textured", {"base": self.base, "texture": self.texture})

    def specification(self) -> None:
        return None
