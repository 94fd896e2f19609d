"""The demo room as an office with a venetian blind, for daylight and EnergyPlus.

The room of `clerestory demo` is 6.1 m wide and 9.1 m deep; its south window has clear
double glazing and, indoors, slats of 25 mm every 20 mm. The model of EnergyPlus is a
zone of the same size between other storeys.
"""

import shutil
from dataclasses import replace
from importlib.resources import files
from pathlib import Path

import numpy as np

from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.input_objects import as_idf
from clerestory.glazing.glazing_system import Gap, GlazingSystem
from clerestory.glazing.layer import Glass
from clerestory.glazing.pane import grey_pane
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.stack import StackedLayers, stack_layers
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

PANE = Glass(replace(grey_pane(0.834, 0.075), thickness=0.003962, conductivity=1.0))
SLAT = replace(
    grey_pane(0.0, 0.7, name="slat"),
    thickness=0.0006,
    conductivity=160.0,
    emissivity_front=0.9,
    emissivity_back=0.9,
)
TILTS = (0, 25, 50, 75)

# Files of the demo
_FILES = ("materials", "room", "workstation", "window"), ("desks", "eyes")

MODEL = """
Version,25.2;
Building,Office,0,City,0.04,0.4,FullInteriorAndExterior,25,6;
Timestep,4;
SimulationControl,No,No,No,No,Yes,No,1;
GlobalGeometryRules,UpperLeftCorner,CounterClockWise,World;
RunPeriod,Year,1,1,,12,31,,,Yes,Yes,No,Yes,Yes;
Site:GroundTemperature:BuildingSurface,18,18,18,18,18,18,18,18,18,18,18,18;
Zone,Office,0,0,0,0,1,1;
Material:NoMass,Insulation,Rough,3,0.9,0.6,0.6;
Material,Board,Smooth,0.0125,0.25,800,1000,0.9,0.4,0.4;
Material,Concrete,Rough,0.15,1.7,2300,900,0.9,0.6,0.6;
Construction,Wall,Insulation,Board;
Construction,Partition,Board,Board;
Construction,Slab,Concrete;
BuildingSurface:Detailed,South,Wall,Wall,Office,,Outdoors,,SunExposed,WindExposed,,4,
  0,0,2.7,0,0,0,6.1,0,0,6.1,0,2.7;
BuildingSurface:Detailed,East,Wall,Partition,Office,,Adiabatic,,NoSun,NoWind,,4,
  6.1,0,2.7,6.1,0,0,6.1,9.1,0,6.1,9.1,2.7;
BuildingSurface:Detailed,North,Wall,Partition,Office,,Adiabatic,,NoSun,NoWind,,4,
  6.1,9.1,2.7,6.1,9.1,0,0,9.1,0,0,9.1,2.7;
BuildingSurface:Detailed,West,Wall,Partition,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,9.1,2.7,0,9.1,0,0,0,0,0,0,2.7;
BuildingSurface:Detailed,Floor,Floor,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,0,0,0,9.1,0,6.1,9.1,0,6.1,0,0;
BuildingSurface:Detailed,Ceiling,Ceiling,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,9.1,2.7,0,0,2.7,6.1,0,2.7,6.1,9.1,2.7;
FenestrationSurface:Detailed,South Window,Window,clear,South,,,,,4,
  0.005,0,2.65,0.005,0,0.85,6.095,0,0.85,6.095,0,2.65;
ScheduleTypeLimits,Any;
Schedule:Constant,Always,Any,1;
Schedule:Constant,Kinds,Any,4;
Schedule:Constant,Activity,Any,120;
Schedule:Compact,Use,Any,Through: 12/31,For: AllDays,Until: 8:00,0,Until: 18:00,1,
  Until: 24:00,0;
Schedule:Compact,Heat,Any,Through: 12/31,For: AllDays,Until: 6:00,16,Until: 18:00,21,
  Until: 24:00,16;
Schedule:Compact,Cool,Any,Through: 12/31,For: AllDays,Until: 6:00,30,Until: 18:00,25,
  Until: 24:00,30;
Lights,Office Lights,Office,Use,LightingLevel,444,,,0,0.4,0.2,0;
ElectricEquipment,Office Equipment,Office,Use,EquipmentLevel,444,,,0,0.5,0;
People,Office People,Office,Use,People,5,,,0.5,,Activity;
ZoneInfiltration:DesignFlowRate,Office Air,Office,Always,AirChanges/Hour,,,,0.7;
ThermostatSetpoint:DualSetpoint,Both,Heat,Cool;
ZoneControl:Thermostat,Office Thermostat,Office,Kinds,
  ThermostatSetpoint:DualSetpoint,Both;
ZoneHVAC:EquipmentConnections,Office,Office Equipment List,Office Inlet,,Office Node,
  Office Return;
ZoneHVAC:EquipmentList,Office Equipment List,SequentialLoad,
  ZoneHVAC:IdealLoadsAirSystem,Office System,1,1;
ZoneHVAC:IdealLoadsAirSystem,Office System,Always,Office Inlet;
"""

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
    found = {"clear": GlazingSystem("clear", (PANE, PANE), (Gap(0.012),))}
    for tilt in TILTS:
        slats = SlatGeometry(width=0.025, spacing=0.02, tilt=np.radians(tilt))
        layers = (PANE, PANE, VenetianBlind(SLAT, slats))
        name = f"tilt_{tilt}"
        found[name] = GlazingSystem(name, layers, (Gap(0.012), Gap(0.05)))
    return found


def stacked(basis: str) -> dict[str, StackedLayers]:
    """Optical properties of all systems on a Klems basis."""
    patches = klems(basis)
    return {
        name: stack_layers(one.layers, partition=patches, method="bands")
        for name, one in systems().items()
    }


def write_glazing(folder: Path, basis: str) -> None:
    """Write the BSDFs of all systems, and the model of EnergyPlus with them."""
    texts = [MODEL]
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
