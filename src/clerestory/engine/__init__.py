"""Light transport on Mitsuba 3 and Dr.Jit, the only package that imports them.

Import these modules through `device.load`, which first chooses a compute device and its
compiler.
"""
