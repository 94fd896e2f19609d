"""The Radiance scene language: scene files, function files, generators, octrees, views.

This package depends on `formats`: scene files include luminaires (ies2rad), MGF
(mgf2rad) and OBJ (mesh primitives).
"""
