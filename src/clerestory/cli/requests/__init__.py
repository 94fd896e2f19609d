"""Requests of the commands: their options, help texts and examples.

Nothing here loads NumPy, so that help appears at once.
"""
