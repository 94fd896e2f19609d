"""Light transport on Mitsuba 3 and Dr.Jit, the only package that imports them.

Nothing here is imported before `device.load` has chosen a compute device and
the compiler behind it: see `device`.
"""
