"""The Radiance scene language: scene files, function files, generators, octrees, views.

The package `radiance` depends on `formats`: scene files may include luminaires
(ies2rad), MGF files (mgf2rad) and OBJ files (mesh primitives).
"""
