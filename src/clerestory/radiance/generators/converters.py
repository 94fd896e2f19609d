"""Radiance's converters mgf2rad and pkgBSDF."""

from collections.abc import Callable, Mapping
from pathlib import Path

from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.files import read_text
from clerestory.formats.mgf import parse_mgf
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.bsdf_package import package
from clerestory.scene.model import Scene
from clerestory.scene.transform import Transform

# Function that returns a scene placed by a transform
Build = Callable[[Transform], Scene]
Find = Callable[[str], Path]


def mgf2rad(words: WordReader, find: Find) -> Build:
    """Return a function that builds the scene of `mgf2rad file.mgf …`."""
    paths = _paths(words, find, idle=())
    texts = [(read_text(path), path) for path in paths]

    def build(place: Transform) -> Scene:
        scene = Scene()
        for text, path in texts:
            scene = scene + parse_mgf(text, file=path, transform=place)
        return scene

    return build


def pkg_bsdf(words: WordReader, find: Find) -> Build:
    """Return a function that builds the scene of `pkgBSDF [-s] [-i] file.xml …`.

    The options -s and -i are ignored.
    """
    paths = _paths(words, find, idle=("-s", "-i"))
    layers = [(read_bsdf(path), path.stem) for path in paths]

    def build(place: Transform) -> Scene:
        scene = Scene()
        for bsdf, name in layers:
            scene = scene + package(bsdf, name, transform=place)
        return scene

    return build


BUILDERS: Mapping[str, Callable[[WordReader, Find], Build]] = {
    "mgf2rad": mgf2rad,
    "pkgBSDF": pkg_bsdf,
}


def _paths(words: WordReader, find: Find, *, idle: tuple[str, ...]) -> list[Path]:
    names = []
    while words.left:
        word = words.word("a file")
        if word.startswith("-") and word not in idle:
            raise words.unknown(word)
        names += [] if word.startswith("-") else [word]
    if not names:
        raise words.error("the command has no file")
    return [find(name) for name in names]
