"""The Radiance scene language: scene files, function files, generators, octrees, views.

`formats` is below this package: commands of the language read luminaires (ies2rad), MGF
(mgf2rad) and OBJ (mesh primitives), and no format needs the language.
"""
