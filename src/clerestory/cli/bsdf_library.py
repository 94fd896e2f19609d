"""`clerestory bsdf library`: built-in BSDFs and spectra, listed or written to files."""

from clerestory.bsdf.xml_writer import usual_digits, write_bsdf
from clerestory.checks import require
from clerestory.cli.progress import say
from clerestory.cli.requests.bsdf import BsdfLibrary
from clerestory.constants import LIBRARY_PREFIX
from clerestory.files import write_text
from clerestory.library.bsdf_source import library_bsdf
from clerestory.library.catalogue import RECIPES, TILTS
from clerestory.spectral.material_library import material_samples
from clerestory.spectral.spectrum_file import format_spectrum


def library(request: BsdfLibrary) -> None:
    """List the built-in BSDFs and spectra, or write one."""
    word = (request.name or "").removeprefix(LIBRARY_PREFIX)
    if request.output is not None:
        require(word, "no name of a built-in BSDF to write; one expected")
        if word in material_samples():
            text = format_spectrum(material_samples()[word].reflectance, "reflectance")
            write_text(request.output, text)
            say(f"{request.output}: {word}")
            return
        bsdf = library_bsdf(word)
        comment = f"clerestory bsdf library {word}".replace("--", "-")
        write_bsdf(request.output, bsdf, digits=usual_digits(bsdf), comment=comment)
        say(f"{request.output}: {word}")
        return
    found = {name: recipe for name, recipe in RECIPES.items() if word in name}
    spectra = {name: one for name, one in material_samples().items() if word in name}
    require(
        found or spectra,
        f"no built-in BSDF or spectrum has {word[:60]!r} in its name; another expected",
    )
    for family in dict.fromkeys(recipe.family for recipe in found.values()):
        say(f"{family}s:")
        for name, recipe in found.items():
            if recipe.family == family:
                shown = f"{name}@TILT" if recipe.tilts else name
                say(f"  {shown:24} {recipe.words}")
    if any(recipe.tilts for recipe in found.values()):
        tilts = ", ".join(map(str, TILTS))
        say(f"TILT: {tilts}, or any whole number from -90 to 90 degrees; default 0")
    if spectra:
        say("spectra of materials (USGS Spectral Library 7):")
        say(*(f"  {name:24} {one.words}" for name, one in spectra.items()))
