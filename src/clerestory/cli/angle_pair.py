"""Directions on the command line: polar angle and azimuth, separated by a comma."""

from clerestory.errors import InputError


def angle_pair(text: str) -> tuple[float, float]:
    """Return polar angle and azimuth [°] of a text such as `40,90`.

    Raises
    ------
    InputError : the text is not two numbers

    Examples
    --------
    >>> angle_pair("40,90")
    (40.0, 90.0)
    """
    try:
        theta, phi = (float(word) for word in text.split(","))
    except ValueError as error:
        raise InputError(
            f"direction {text!r}; two angles such as 40,90 expected"
        ) from error
    return theta, phi
