"""Writer of scenes as Radiance scene files."""

from collections.abc import Iterator, Mapping
from pathlib import Path

from clerestory.bands import RGB
from clerestory.bsdf.bsdf import Bsdf
from clerestory.checks import require
from clerestory.errors import InputError
from clerestory.escaping import radiance_name, radiance_word
from clerestory.radiance.primitives import specification
from clerestory.scene.material import Argument, Material, Specification, insert_material
from clerestory.scene.materials.mixture import Void
from clerestory.scene.model import Scene
from clerestory.scene.pattern import Pattern
from clerestory.scene.primitive import Primitive, primitive
from clerestory.scene.surface import Polygon, Simple, TriangleMesh


def format_rad(scene: Scene, *, bsdf_file: Mapping[str, str | Path]) -> str:
    """Return a scene as the text of a Radiance scene file.

    `bsdf_file` gives the path of the BSDF file for each material key.
    """
    require(
        scene.bands == RGB, f"the scene is in the bands {scene.bands}; {RGB} expected"
    )
    writer = _Writer(bsdf_file)
    name_of = {key: writer.define(m, key) for key, m in scene.materials.items()}
    for number, surface in enumerate((*scene.surfaces, *scene.distant), 1):
        name = radiance_name(surface.name or f"surface{number}")
        for shape in _shapes(surface):
            made = primitive(name_of[surface.material], shape.kind, name, shape.reals)
            writer.text.append(primitive_text(made))
    return "\n".join(writer.text)


class _Writer:
    def __init__(self, bsdf_file: Mapping[str, str | Path]) -> None:
        self.text: list[str] = []
        self.written: dict[str, Material] = {}
        self.bsdf_file = bsdf_file

    def define(self, material: Material, key: str) -> str:
        """Write a material after its component materials; return the written name."""
        if isinstance(material, Void):
            return "void"
        given = material.specification()
        if given is None:
            raise InputError(
                f'material "{key}" has a pattern or a texture, which cannot be written'
                " to a scene file; a plain material expected"
            )
        strings = tuple(self.word(each, material, key) for each in given.strings)
        self.written[key] = material
        name = radiance_name(key)
        made = primitive("void", given.kind, name, given.reals, strings)
        self.text.append(primitive_text(made))
        return name

    def word(self, value: Argument, material: Material, key: str) -> str:
        """Return the text of a string argument."""
        match value:
            case str():
                return value
            case Material():
                return self.held(value)
            case Bsdf() if key in self.bsdf_file:
                return str(self.bsdf_file[key])
            case Bsdf():
                raise InputError(
                    f'no BSDF file is given for "{key}"; one in `bsdf_file` expected'
                )
            case Pattern():
                raise InputError(
                    f'material "{material.name}" has a pattern or function, which'
                    " cannot be written; constant values expected"
                )
        return f"{value:.12g}"

    def held(self, material: Material) -> str:
        """Return the name of a component material, written first if necessary."""
        if isinstance(material, Void):
            return "void"
        known = set(self.written)
        key = insert_material(self.written, material)
        return radiance_name(key) if key in known else self.define(material, key)


def _shapes(surface: Polygon | Simple) -> Iterator[Specification]:
    # A mesh is written as one polygon per triangle
    if isinstance(surface, TriangleMesh):
        for corners in surface.vertices[surface.faces]:
            yield Specification("polygon", (), (*corners.ravel(),))
    else:
        yield specification(surface)


def primitive_text(item: Primitive) -> str:
    """Return a primitive as text of a scene file.

    Names come from `radiance_name`; other words that could be misread are refused.
    """
    words = " ".join([str(len(item.strings)), *map(radiance_word, item.strings)])
    numbers = " ".join([str(len(item.reals)), *(f"{v:.12g}" for v in item.reals)])
    head = f"{radiance_word(item.modifier)} {item.kind} {radiance_word(item.name)}"
    return f"{head}\n{words}\n0\n{numbers}\n"
