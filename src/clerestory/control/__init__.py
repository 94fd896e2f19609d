"""Control of shading devices: the state of each window group at each time step."""
