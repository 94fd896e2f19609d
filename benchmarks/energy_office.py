"""The demo room as an office with a venetian blind, for daylight and EnergyPlus.

The room of `clerestory demo` is 6.1 m wide and 9.1 m deep; its south window has clear
double glazing and, indoors, slats of 25 mm every 20 mm. The model of EnergyPlus is a
zone of the same size between other storeys.
"""

import shutil
import sys
from importlib.resources import files
from pathlib import Path

from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.input_objects import as_idf
from clerestory.glazing.glazing_system import GlazingSystem
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.hemisphere.klems import klems

sys.path.insert(0, str(Path(__file__).parents[1] / "tests"))
from energy_models import DEMO_OFFICE, double_glazing, shaded_glazing

TILTS = (0, 25, 50, 75)

# Files of the demo
_FILES = ("materials", "room", "workstation", "window"), ("desks", "eyes")

STUDY = """
title = "Office, {title}"
method = "{method}"
[scene]
files = ["materials.rad", "room.rad"]
[[window]]
name = "south"
file = "window.rad"
{states}
[window.control]
{rule}
[[sensors]]
name = "desks"
file = "desks.pts"
[[sensors]]
name = "eyes"
file = "eyes.pts"
[[luminaire]]
file = "lamp.rad"
power = 444
[[lighting]]
grid = "desks"
[weather]
file = "{weather}"
[sky]
subdivision = 1
[trace]
relative_error = 0.03
[energy]
model = "office.idf"
solar = "{solar}"
[[energy.window]]
name = "south"
surfaces = ["South Window"]
constructions = [{constructions}]
[[energy.lights]]
lights = "Office Lights"
"""

LAMP = """void light lamp 0 0 3 1.3 1.3 1.3
lamp polygon panel 0 0 12 1 2 2.69 1 7 2.69 5 7 2.69 5 2 2.69
"""


def systems() -> dict[str, GlazingSystem]:
    """Double glazing, and the same with the blind at each tilt."""
    found = [double_glazing(), *(shaded_glazing(t, f"tilt_{t}") for t in TILTS)]
    return {one.name: one for one in found}


def stacked(basis: str) -> dict[str, StackedLayers]:
    """Optical properties of all systems on a Klems basis."""
    patches = klems(basis)
    return {
        name: stack_layers(one.layers, partition=patches, method="bands")
        for name, one in systems().items()
    }


def write_glazing(folder: Path, basis: str) -> None:
    """Write the BSDFs of all systems, and the model of EnergyPlus with them."""
    texts = [DEMO_OFFICE.text("clear")]
    for (name, system), light in zip(
        systems().items(), stacked(basis).values(), strict=True
    ):
        write_bsdf(folder / f"{name}.xml", light.bsdf)
        texts.append(as_idf(complex_fenestration(system, light, name=name)))
    (folder / "office.idf").write_text("\n".join(texts))


def write_study(
    folder: Path,
    rule: str,
    *,
    weather: Path,
    title: str = "venetian blind",
    solar: str = "EnergyPlus",
    method: str = "5-phase",
) -> Path:
    """Write the files of a study with a control rule; the glazing is there before."""
    names = [f"{each}.rad" for each in _FILES[0]] + [
        f"{each}.pts" for each in _FILES[1]
    ]
    for name in names:
        shutil.copy(str(files("clerestory") / "demo" / name), folder)
    (folder / "lamp.rad").write_text(LAMP)
    shutil.copy(weather, folder / weather.name)
    names = list(systems())
    states = "\n".join(f'[[window.state]]\nbsdf = "{name}.xml"' for name in names)
    text = STUDY.format(
        title=title,
        method=method,
        states=states,
        rule=rule,
        weather=weather.name,
        solar=solar,
        constructions=", ".join(f'"{name}"' for name in names),
    )
    path = folder / "study.toml"
    path.write_text(text)
    return path
