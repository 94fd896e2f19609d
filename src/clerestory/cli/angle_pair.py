"""Directions on the command line: polar angle and azimuth, separated by a comma."""

from clerestory.errors import InputError


def angle_pair(text: str) -> tuple[float, float]:
    """Return polar angle and azimuth [°] of a text such as `40,90`."""
    try:
        theta, phi = (float(word) for word in text.split(","))
    except ValueError as error:
        message = f"direction is {text!r}; two angles such as 40,90 expected"
        raise InputError(message) from error
    return theta, phi
