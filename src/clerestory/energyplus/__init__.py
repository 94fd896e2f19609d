"""Input of EnergyPlus: complex fenestration states."""
