"""Zones of one window for EnergyPlus, with panes and blinds: tests and benchmarks."""

from dataclasses import dataclass, replace

import numpy as np

from clerestory.energyplus.building_model import read_building_model
from clerestory.energyplus.engine_run import AnnualRun, simulate
from clerestory.glazing.glazing_system import Gap, GlazingSystem
from clerestory.glazing.layer import Glass
from clerestory.glazing.pane import grey_pane
from clerestory.glazing.slat_cell import SlatGeometry
from clerestory.glazing.venetian import VenetianBlind
from clerestory.hemisphere.klems import klems

BASIS = klems("quarter")
PANE = Glass(replace(grey_pane(0.834, 0.075), thickness=0.003962, conductivity=1.0))
SLAT = replace(
    grey_pane(0.0, 0.7, name="slat"),
    thickness=0.0006,
    conductivity=160.0,
    emissivity_front=0.9,
    emissivity_back=0.9,
)


def blind(tilt_deg):
    """A blind of 25 mm slats every 20 mm."""
    slats = SlatGeometry(width=0.025, spacing=0.02, tilt=np.radians(tilt_deg))
    return VenetianBlind(SLAT, slats)


def annual_outputs(folder, weather, text, outputs):
    """Hourly outputs of EnergyPlus for IDF text, over (output, hour)."""
    path = folder / "in.idf"
    path.write_text(text)
    model = read_building_model(path).objects
    return simulate(AnnualRun(model, weather, [], outputs))


def double_glazing(name="clear"):
    """Two clear panes of 4 mm and 12 mm of air, as PLAIN has them."""
    return GlazingSystem(name, (PANE, PANE), (Gap(0.012),))


def shaded_glazing(tilt_deg, name="blind"):
    """The same with a blind indoors."""
    layers = (PANE, PANE, blind(tilt_deg))
    return GlazingSystem(name, layers, (Gap(0.012), Gap(0.05)))


@dataclass(frozen=True)
class Zone:
    """A zone with a window to the south, between zones of the same temperature.

    Attributes
    ----------
    size : width, depth and height [m]
    window : left, right, lower and upper edge [m]
    materials : objects of materials and of the constructions Wall, Partition and Slab
    use : schedules Use, Heat and Cool, and people
    power : power of the luminaires, and of equipment [W]
    air_changes : infiltration [1/h]
    """

    size: tuple[float, float, float]
    window: tuple[float, float, float, float]
    materials: str
    use: str
    power: float
    air_changes: float

    def text(self, construction, *objects, coordinates="World", north=0, turn=0):
        """IDF text of the zone, whose window has a construction, and more objects."""
        edges = ("left", "right", "low", "high")
        text = _ZONE.format(
            **dict(zip("xyz", self.size, strict=True)),
            **dict(zip(edges, self.window, strict=True)),
            materials=self.materials,
            use=self.use,
            power=self.power,
            air=self.air_changes,
            construction=construction,
            coordinates=coordinates,
            north=north,
            turn=turn,
        )
        return "\n".join([text, *objects])


_ZONE = """
Version,25.2;
Building,Office,{north},City,0.04,0.4,FullInteriorAndExterior,25,6;
Timestep,4;
SimulationControl,No,No,No,No,Yes,No,1;
GlobalGeometryRules,UpperLeftCorner,CounterClockWise,{coordinates};
RunPeriod,Year,1,1,,12,31,,,Yes,Yes,No,Yes,Yes;
Site:GroundTemperature:BuildingSurface,18,18,18,18,18,18,18,18,18,18,18,18;
Zone,Office,{turn},0,0,0,1,1;
{materials}
BuildingSurface:Detailed,South,Wall,Wall,Office,,Outdoors,,SunExposed,WindExposed,,4,
  0,0,{z},0,0,0,{x},0,0,{x},0,{z};
BuildingSurface:Detailed,East,Wall,Partition,Office,,Adiabatic,,NoSun,NoWind,,4,
  {x},0,{z},{x},0,0,{x},{y},0,{x},{y},{z};
BuildingSurface:Detailed,North,Wall,Partition,Office,,Adiabatic,,NoSun,NoWind,,4,
  {x},{y},{z},{x},{y},0,0,{y},0,0,{y},{z};
BuildingSurface:Detailed,West,Wall,Partition,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,{y},{z},0,{y},0,0,0,0,0,0,{z};
BuildingSurface:Detailed,Floor,Floor,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,0,0,0,{y},0,{x},{y},0,{x},0,0;
BuildingSurface:Detailed,Ceiling,Ceiling,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,{y},{z},0,0,{z},{x},0,{z},{x},{y},{z};
FenestrationSurface:Detailed,South Window,Window,{construction},South,,,,,4,
  {left},0,{high},{left},0,{low},{right},0,{low},{right},0,{high};
ScheduleTypeLimits,Any;
Schedule:Constant,Always,Any,1;
Schedule:Constant,Kinds,Any,4;
{use}
Lights,Office Lights,Office,Use,LightingLevel,{power},,,0,0.4,0.2,0;
ElectricEquipment,Office Equipment,Office,Use,EquipmentLevel,{power},,,0,0.5,0;
ZoneInfiltration:DesignFlowRate,Office Air,Office,Always,AirChanges/Hour,,,,{air};
ThermostatSetpoint:DualSetpoint,Both,Heat,Cool;
ZoneControl:Thermostat,Office Thermostat,Office,Kinds,
  ThermostatSetpoint:DualSetpoint,Both;
ZoneHVAC:EquipmentConnections,Office,Office Equipment List,Office Inlet,,Office Node,
  Office Return;
ZoneHVAC:EquipmentList,Office Equipment List,SequentialLoad,
  ZoneHVAC:IdealLoadsAirSystem,Office System,1,1;
ZoneHVAC:IdealLoadsAirSystem,Office System,Always,Office Inlet;
"""

# A room of concrete that is used in all hours; its window is 2 m wide and 1.5 m high
SMALL_OFFICE = Zone(
    size=(4, 5, 3),
    window=(1, 3, 1, 2.5),
    materials="""
Material:NoMass,Insulation,Rough,4,0.9,0.6,0.6;
Material,Concrete,Rough,0.1,1.7,2300,900,0.9,0.6,0.6;
Construction,Wall,Insulation,Concrete;
Construction,Partition,Concrete;
Construction,Slab,Concrete;
""",
    use="""
Schedule:Constant,Use,Any,1;
Schedule:Constant,Heat,Any,20;
Schedule:Constant,Cool,Any,26;
""",
    power=100,
    air_changes=0.5,
)

# The room of `clerestory demo`, used from 8 to 18 h
DEMO_OFFICE = Zone(
    size=(6.1, 9.1, 2.7),
    window=(0.005, 6.095, 0.85, 2.65),
    materials="""
Material:NoMass,Insulation,Rough,3,0.9,0.6,0.6;
Material,Board,Smooth,0.0125,0.25,800,1000,0.9,0.4,0.4;
Material,Concrete,Rough,0.15,1.7,2300,900,0.9,0.6,0.6;
Construction,Wall,Insulation,Board;
Construction,Partition,Board,Board;
Construction,Slab,Concrete;
""",
    use="""
Schedule:Constant,Activity,Any,120;
Schedule:Compact,Use,Any,Through: 12/31,For: AllDays,Until: 8:00,0,Until: 18:00,1,
  Until: 24:00,0;
Schedule:Compact,Heat,Any,Through: 12/31,For: AllDays,Until: 6:00,16,Until: 18:00,21,
  Until: 24:00,16;
Schedule:Compact,Cool,Any,Through: 12/31,For: AllDays,Until: 6:00,30,Until: 18:00,25,
  Until: 24:00,30;
People,Office People,Office,Use,People,5,,,0.5,,Activity;
""",
    power=444,
    air_changes=0.7,
)

# Two clear panes of 4 mm and 12 mm of air, as objects for ordinary windows
PLAIN = """
WindowMaterial:Glazing,Pane,SpectralAverage,,0.003962,0.834,0.075,0.075,0.834,0.075,
  0.075,0,0.84,0.84,1.0;
WindowMaterial:Gas,Space,Air,0.012;
Construction,plain,Pane,Space,Pane;
"""
