"""`clerestory bsdf library`: built-in BSDFs, listed or written to a file."""

from clerestory.bsdf.xml_writer import usual_digits, write_bsdf
from clerestory.checks import require
from clerestory.cli.progress import say
from clerestory.cli.requests.bsdf import BsdfLibrary
from clerestory.library.bsdf_source import PREFIX, library_bsdf
from clerestory.library.catalogue import RECIPES, TILTS


def library(request: BsdfLibrary) -> None:
    """List the built-in BSDFs, or write one."""
    word = (request.name or "").removeprefix(PREFIX)
    if request.output is not None:
        require(word, "no name of a built-in BSDF to write; one expected")
        bsdf = library_bsdf(word)
        comment = f"clerestory bsdf library {word}".replace("--", "-")
        write_bsdf(request.output, bsdf, digits=usual_digits(bsdf), comment=comment)
        say(f"{request.output}: {word}")
        return
    found = {name: recipe for name, recipe in RECIPES.items() if word in name}
    require(found, f"no built-in BSDF has {word[:60]!r} in its name; another expected")
    for family in dict.fromkeys(recipe.family for recipe in found.values()):
        say(f"{family}s:")
        for name, recipe in found.items():
            if recipe.family == family:
                shown = f"{name}@TILT" if recipe.tilts else name
                say(f"  {shown:24} {recipe.words}")
    if any(recipe.tilts for recipe in found.values()):
        tilts = ", ".join(map(str, TILTS))
        say(f"TILT: {tilts}, or any whole number from -90 to 90 degrees; default 0")
