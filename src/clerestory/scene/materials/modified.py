"""Materials modified by a pattern (colour) or a texture (surface normal)."""

from dataclasses import dataclass

from clerestory.scene.material import Material, Plugin, Source
from clerestory.scene.pattern import Pattern


@dataclass(frozen=True, eq=False)
class Patterned(Material):
    """A material whose colour (glass: transmissivity) is multiplied by a pattern."""

    name: str
    base: Material
    pattern: Pattern
    source: Source | None = None

    @property
    def opaque(self) -> bool:
        return self.base.opaque

    @property
    def mirrored(self) -> float:
        return self.base.mirrored

    @property
    def lambertian(self) -> bool:
        return self.base.lambertian

    def plugin(self) -> Plugin:
        base = self.base.plugin()
        return Plugin(base.name, {**base.parameters, "pattern": self.pattern})

    def specification(self) -> None:
        return None


@dataclass(frozen=True, eq=False)
class Textured(Material):
    """A material with a texture, a vector function that is added to the unit normal."""

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
