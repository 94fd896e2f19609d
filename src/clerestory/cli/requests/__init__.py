"""Requests of the commands: options, help texts and examples.

These modules do not import NumPy, so that help is printed without delay.
"""
