"""Reader of Radiance scene files (.rad).

Commands (`!xform …`, `!cat …`) are evaluated without a shell. Files named in commands
are searched for in the folder of the file given to `read_rad`, in the folder of the
file with the command and in the current directory. BSDF files are searched for in the
folder of the file that refers to them, in the current directory and in the folders of
RAYPATH.

References: G. Ward, "The RADIANCE 6.0 Synthetic Imaging System", section 2 (ray.html).
"""

from dataclasses import dataclass, field, replace
from pathlib import Path

from clerestory.bsdf.bsdf import Bsdf
from clerestory.library.bsdf_source import is_library_name, read_bsdf
from clerestory.radiance.expansion import placed_items
from clerestory.radiance.modifiers import Modifiers, modified
from clerestory.radiance.pattern_reader import (
    PATTERN_KINDS,
    read_coefficients,
    read_modifiers,
    read_share,
    read_vector,
)
from clerestory.radiance.placement import Placement
from clerestory.radiance.repetition import Placed, Scope
from clerestory.radiance.search_path import library_file
from clerestory.radiance.statements import Directive, PolygonRun
from clerestory.scene.material import (
    Material,
    Source,
    altered,
    error_at,
    insert_material,
)
from clerestory.scene.materials import read_material
from clerestory.scene.materials.emitters import Glow, Light
from clerestory.scene.materials.mixture import Void
from clerestory.scene.model import Scene
from clerestory.scene.primitive import Arguments, Definition, Primitive
from clerestory.scene.surface import DistantSource, Surface

# Key of the modifier "void", which stands for no material
_VOID = ""


def read_rad(*paths: str | Path) -> Scene:
    """Read a scene from one or several Radiance scene files.

    A later definition of a material applies to the surfaces after it. Surfaces of the
    material void are omitted. Polygons of zero area are omitted and non-planar polygons
    kept, each with a warning.

    Parameters
    ----------
    paths : scene files (.rad); materials must be defined before they are used

    Raises
    ------
    InputError : a file is missing, malformed, includes itself, uses an undefined name,
        or contains an unsupported material, surface or command

    Examples
    --------
    >>> import tempfile
    >>> text = "void light lamp 0 0 3 1 1 1  lamp sphere bulb 0 0 4 0 0 2 0.1"
    >>> with tempfile.TemporaryDirectory() as folder:
    ...     file = Path(folder, "lamp.rad")
    ...     _ = file.write_text(text)
    ...     scene = read_rad(file)
    >>> scene.surfaces[0].radius, scene.surfaces[0].material
    (0.1, 'lamp')
    """
    reading = _Reading()
    for path in paths:
        for item in placed_items(path):
            reading.add(item)
    return Scene(reading.materials, tuple(reading.surfaces), tuple(reading.distant))


@dataclass
class _Reading:
    # Scene read so far
    materials: dict[str, Material] = field(default_factory=dict)
    surfaces: list[Surface] = field(default_factory=list)
    distant: list[DistantSource] = field(default_factory=list)
    bsdfs: dict[Path, Bsdf] = field(default_factory=dict)
    # Key of a material, or patterns and textures combined with their own modifiers, by
    # name; `bare` has patterns and textures without modifiers
    named: dict[str, str | Modifiers] = field(default_factory=lambda: {"void": _VOID})
    outside: list[dict[str, str | Modifiers]] = field(default_factory=list)
    bare: dict[str, Modifiers] = field(default_factory=dict)
    # Materials by key, without the patterns and textures that modify them
    unmodified: dict[str, Material] = field(default_factory=dict)

    def add(self, placed: Placed) -> None:
        match placed.item:
            case PolygonRun():
                made = placed.item.polygons(self._key)
                self.surfaces += (p for p in made if p.material != _VOID)
            case Primitive(kind="alias"):
                self._alias(Arguments(placed.item, placed.file))
            case Primitive():
                self._define(Arguments(placed.item, placed.file), placed.placement)
            case DistantSource():
                self._add_distant(placed.item)
            case Scope(opens=True):
                self.outside.append(dict(self.named))
            case Scope():
                self.named = self.outside.pop()
            case Scene():
                self._add_scene(placed.item, placed.file, placed.placement)
            case Directive():
                pass  # used by `window_reader` only
            case surface:
                source = surface.source or Source(placed.file, 0)
                key = self._key(surface.material, source)
                if key != _VOID:
                    self.surfaces.append(replace(surface, material=key))

    def _key(self, modifier: str, source: Source) -> str:
        found = self.named.get(modifier)
        if isinstance(found, str):
            return found
        if found is None:
            raise error_at(
                source,
                f'undefined modifier "{modifier}"; a material defined before this line,'
                " or in a file given before this one, expected",
            )
        raise error_at(
            source, f'the modifier "{modifier}" is a pattern; a material expected'
        )

    def _add_scene(self, scene: Scene, file: str, placement: Placement) -> None:
        # Adds a scene; the modifier of xform, if any, replaces all its materials
        given = scene.materials.items()
        keys = {name: insert_material(self.materials, m) for name, m in given}
        for surface in scene.surfaces:
            key = keys[surface.material]
            if placement.modifier is not None:
                key = self._key(placement.modifier, Source(file, 0))
            if key != _VOID:
                turned = placement.turned(surface)
                name = placement.name(surface.name)
                self.surfaces.append(replace(turned, material=key, name=name))
        if placement.modifier is None:
            self.named |= keys

    def _add_distant(self, item: DistantSource) -> None:
        source = item.source or Source("", 0)
        key = self._key(item.material, source)
        if key == _VOID:
            return
        if not isinstance(self.materials[key], Glow | Light):
            wrong = f'source "{item.name}" has the material "{key}"'
            raise error_at(source, f"{wrong}; a glow or a light expected")
        self.distant.append(replace(item, material=key))

    def _define(self, given: Arguments, placement: Placement) -> None:
        item = given.item
        if item.kind in PATTERN_KINDS:
            self._define_modifiers(given, placement)
            return
        value = read_material(
            Definition(
                item,
                given.file,
                placed=placement.transform,
                named=lambda name: self._named(name, given.source),
                bsdf=lambda name: self._bsdf(name, given.source),
                vector=lambda first, placed: read_vector(given, placed, first),
                share_of_foreground=lambda: read_share(given, placement.transform),
                coefficients=lambda: read_coefficients(given, placement.transform),
            )
        )
        self._name_material(value, self._modifying(given), given)

    def _name_material(
        self, value: Material, modifiers: Modifiers | None, given: Arguments
    ) -> None:
        made = value if modifiers is None else modified(value, modifiers, given)
        key = self.named[given.item.name] = insert_material(self.materials, made)
        if modifiers is not None:
            self.unmodified[key] = value

    def _define_modifiers(self, given: Arguments, placement: Placement) -> None:
        modifiers = read_modifiers(given, placed=placement.transform)
        item = given.item
        outer = self.named.get(item.modifier)
        if isinstance(outer, Modifiers) or item.modifier == "void":
            with given.located():
                self._name_modifiers(item.name, modifiers, self._modifying(given))
            return
        # A pattern modified by a material defines a new material, as in Radiance
        value = altered(self._named(item.modifier, given.source), name=item.name)
        self._name_material(value, modifiers, given)

    def _name_modifiers(
        self, name: str, modifiers: Modifiers, outer: Modifiers | None
    ) -> None:
        self.bare[name] = modifiers
        self.named[name] = modifiers.within(outer)

    def _modifying(self, given: Arguments) -> Modifiers | None:
        # Patterns and textures that modify a primitive; None for void
        modifier = given.item.modifier
        found = self.named.get(modifier)
        if isinstance(found, Modifiers):
            return found
        if self._key(modifier, given.source) != _VOID:
            raise error_at(
                given.source,
                f'the modifier of {given.subject} is the material "{modifier}"; void,'
                " a pattern or a texture expected",
            )
        return None

    def _named(self, name: str, source: Source) -> Material:
        key = self._key(name, source)
        return Void() if key == _VOID else self.materials[key]

    def _bsdf(self, name: str, source: Source) -> Bsdf:
        # A BSDF file is read only once, so that equal materials are recognized
        path = Path(name)
        if not is_library_name(name):
            path = library_file(name, beside=source.file, line=source.line).resolve()
        if path not in self.bsdfs:
            self.bsdfs[path] = read_bsdf(path)
        return self.bsdfs[path]

    def _alias(self, given: Arguments) -> None:
        # "inherit" keeps the modifiers of the alias target; any other replaces them
        name, (target,) = given.item.name, given.item.strings
        if target == "void":
            message = f'alias "{name}" refers to void; a material expected'
            raise error_at(given.source, message)
        inherits = given.item.modifier == "inherit"
        outer = None if inherits else self._modifying(given)
        whole = self.named.get(target)
        if isinstance(whole, Modifiers):
            self._name_modifiers(name, whole if inherits else self.bare[target], outer)
            return
        key = self._key(target, given.source)
        if not inherits and (outer or key in self.unmodified):
            value = self.unmodified.get(key, self.materials[key])
            self._name_material(altered(value, name=name), outer, given)
            return
        self.named[name] = key
