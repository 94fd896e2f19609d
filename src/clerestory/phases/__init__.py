"""Matrix methods of annual daylight simulation, from two to six phases."""
