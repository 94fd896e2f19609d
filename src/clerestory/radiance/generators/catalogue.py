"""Registry of scene generators."""

from collections.abc import Callable, Mapping
from pathlib import Path

from clerestory.errors import InputError
from clerestory.formats.word_reader import WordReader
from clerestory.radiance.generators.blinds import blinds
from clerestory.radiance.generators.box import box
from clerestory.radiance.generators.cie_sky import gensky
from clerestory.radiance.generators.formula import revolution, surface, worm
from clerestory.radiance.generators.luminaire import ies2rad
from clerestory.radiance.generators.perez_sky import gendaylit
from clerestory.radiance.generators.prism import prism

Find = Callable[[str], Path]


GENERATORS: Mapping[str, Callable[[WordReader, Find], list[str]]] = {
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


def generate(program: str, words: list[str], find: Find) -> str:
    """Return the output of a generator as scene text on a single line.

    Parameters
    ----------
    program : name of the generator
    words : arguments of the generator
    find : function that returns the path of a file named in the command

    Examples
    --------
    >>> text = generate("genbox", ["wood", "desk", "1", "2", "3"], Path)
    >>> text.count("wood polygon desk.")
    6
    """
    if program not in GENERATORS:
        raise InputError(f'the generator "{program}" is unknown')
    return " ".join(GENERATORS[program](WordReader(words, program), find))
