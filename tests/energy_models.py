"""An office of one zone for EnergyPlus, with panes and blinds, made for the tests."""

from dataclasses import replace

import numpy as np

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


OFFICE = """
Version,25.2;
Building,Office,{north},City,0.04,0.4,FullInteriorAndExterior,25,6;
Timestep,4;
SimulationControl,No,No,No,No,Yes,No,1;
GlobalGeometryRules,UpperLeftCorner,CounterClockWise,{coordinates};
RunPeriod,Year,1,1,,12,31,,,Yes,Yes,No,Yes,Yes;
Site:GroundTemperature:BuildingSurface,18,18,18,18,18,18,18,18,18,18,18,18;
Zone,Office,{turn},0,0,0,1,1;
Material:NoMass,Insulation,Rough,4,0.9,0.6,0.6;
Material,Concrete,Rough,0.1,1.7,2300,900,0.9,0.6,0.6;
Construction,Wall,Insulation,Concrete;
Construction,Slab,Concrete;
BuildingSurface:Detailed,South,Wall,Wall,Office,,Outdoors,,SunExposed,WindExposed,,4,
  0,0,3,0,0,0,4,0,0,4,0,3;
BuildingSurface:Detailed,East,Wall,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  4,0,3,4,0,0,4,5,0,4,5,3;
BuildingSurface:Detailed,North,Wall,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  4,5,3,4,5,0,0,5,0,0,5,3;
BuildingSurface:Detailed,West,Wall,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,5,3,0,5,0,0,0,0,0,0,3;
BuildingSurface:Detailed,Floor,Floor,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,0,0,0,5,0,4,5,0,4,0,0;
BuildingSurface:Detailed,Ceiling,Ceiling,Slab,Office,,Adiabatic,,NoSun,NoWind,,4,
  0,5,3,0,0,3,4,0,3,4,5,3;
FenestrationSurface:Detailed,South Window,Window,{construction},South,,,,,4,
  1,0,2.5,1,0,1,3,0,1,3,0,2.5;
ScheduleTypeLimits,Any;
Schedule:Constant,Always,Any,1;
Schedule:Constant,Heat,Any,20;
Schedule:Constant,Cool,Any,26;
Schedule:Constant,Kinds,Any,4;
Lights,Office Lights,Office,Always,LightingLevel,100,,,0,0.4,0.2,0;
ElectricEquipment,Office Equipment,Office,Always,EquipmentLevel,100,,,0,0.5,0;
ZoneInfiltration:DesignFlowRate,Office Air,Office,Always,AirChanges/Hour,,,,0.5;
ThermostatSetpoint:DualSetpoint,Both,Heat,Cool;
ZoneControl:Thermostat,Office Thermostat,Office,Kinds,
  ThermostatSetpoint:DualSetpoint,Both;
ZoneHVAC:EquipmentConnections,Office,Office Equipment List,Office Inlet,,Office Node,
  Office Return;
ZoneHVAC:EquipmentList,Office Equipment List,SequentialLoad,
  ZoneHVAC:IdealLoadsAirSystem,Office System,1,1;
ZoneHVAC:IdealLoadsAirSystem,Office System,Always,Office Inlet;
"""

# Two clear panes of 4 mm and 12 mm of air, as objects for ordinary windows
PLAIN = """
WindowMaterial:Glazing,Pane,SpectralAverage,,0.003962,0.834,0.075,0.075,0.834,0.075,
  0.075,0,0.84,0.84,1.0;
WindowMaterial:Gas,Space,Air,0.012;
Construction,plain,Pane,Space,Pane;
"""


def office(construction, *objects, coordinates="World", north=0, turn=0):
    """IDF text of the office; its window faces south, 2 m wide and 1.5 m high."""
    text = OFFICE.format(
        construction=construction, coordinates=coordinates, north=north, turn=turn
    )
    return "\n".join([text, *objects])
