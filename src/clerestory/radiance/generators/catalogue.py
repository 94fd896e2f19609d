"""Registry of Radiance's scene generators and file converters."""

from collections.abc import Callable, Mapping
from pathlib import Path

from clerestory.files import read_text
from clerestory.formats.mgf import parse_mgf
from clerestory.formats.word_reader import WordReader
from clerestory.library.bsdf_source import read_bsdf
from clerestory.radiance.bsdf_package import package
from clerestory.radiance.generators.blinds import blinds
from clerestory.radiance.generators.box import box
from clerestory.radiance.generators.cie_sky import gensky
from clerestory.radiance.generators.formula import revolution, surface, worm
from clerestory.radiance.generators.luminaire import ies2rad
from clerestory.radiance.generators.perez_sky import gendaylit
from clerestory.radiance.generators.prism import prism
from clerestory.scene.model import Scene
from clerestory.scene.primitive import Primitive
from clerestory.scene.transform import Transform

# Function that returns the path of a file named in a command
Find = Callable[[str], Path]

# Function that returns a converted scene, given the transform to apply to it
Build = Callable[[Transform], Scene]

GENERATORS: Mapping[str, Callable[[WordReader, Find], list[Primitive]]] = {
    "genbox": lambda words, _: box(words),
    "genprism": prism,
    "gensurf": surface,
    "genrev": revolution,
    "genworm": worm,
    "genblinds": lambda words, _: blinds(words),
    "gensky": lambda words, _: gensky(words),
    "gendaylit": lambda words, _: gendaylit(words),
    "ies2rad": ies2rad,
}


def mgf2rad(words: WordReader, find: Find) -> Build:
    """Return a function that builds the scene for `mgf2rad file.mgf …`."""
    texts = [(path, read_text(path)) for path in _paths(words, find)]

    def build(place: Transform) -> Scene:
        parts = (parse_mgf(t, file=p, transform=place) for p, t in texts)
        return sum(parts, Scene())

    return build


def pkg_bsdf(words: WordReader, find: Find) -> Build:
    """Return a function that builds the scene for `pkgBSDF [-s] [-i] file.xml …`.

    The options -s and -i are ignored.
    """
    paths = _paths(words, find, ignored=("-s", "-i"))
    layers = [(read_bsdf(path), path.stem) for path in paths]

    def build(place: Transform) -> Scene:
        parts = (package(bsdf, name, transform=place) for bsdf, name in layers)
        return sum(parts, Scene())

    return build


CONVERTERS: Mapping[str, Callable[[WordReader, Find], Build]] = {
    "mgf2rad": mgf2rad,
    "pkgBSDF": pkg_bsdf,
}


def _paths(words: WordReader, find: Find, ignored: tuple[str, ...] = ()) -> list[Path]:
    names = []
    while words.left:
        word = words.word("a file")
        if not word.startswith("-"):
            names.append(word)
        elif word not in ignored:
            raise words.unknown(word)
    if not names:
        raise words.error("the command has no file; one or more expected")
    return [find(name) for name in names]
