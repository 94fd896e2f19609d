"""Camera response curves: exposure as a function of pixel value.

A curve belongs to a camera and its settings. It is recovered once from a bracket and
kept in a file, or read from one of hdrgen's .rsp files.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from clerestory.errors import InputError
from clerestory.files import read_text, write_text
from clerestory.image.opencv import opencv
from clerestory.image.photograph import Exposure, Photograph

Method = Literal["debevec", "robertson"]

LEVELS = 256

# The value at which curves are 1
_MIDDLE = 128


@dataclass(frozen=True, eq=False)
class ResponseCurve:
    """Exposure behind each value of red, green and blue.

    Attributes
    ----------
    exposure : relative exposure of each of 256 values, 1 at value 128

    Raises
    ------
    InputError : another shape, values that are not finite and positive in the middle

    Examples
    --------
    >>> curve = srgb_response()
    >>> curve.exposure[[0, 128, 255], 1].round(3).tolist()
    [0.0, 1.0, 4.633]
    """

    exposure: Float[np.ndarray, "256 3"]

    def __post_init__(self) -> None:
        curve = np.asarray(self.exposure, dtype=float)
        if curve.shape != (LEVELS, 3):
            raise InputError(f"a response of shape {curve.shape}; (256, 3) expected")
        if not np.isfinite(curve).all() or (curve[_MIDDLE] <= 0).any():
            raise InputError("a response that is not finite and positive in the middle")
        object.__setattr__(self, "exposure", curve / curve[_MIDDLE])

    def monotonic(self) -> "ResponseCurve":
        """Return the curve with its dips filled: more light never means less."""
        rising = np.maximum.accumulate(np.maximum(self.exposure, 0), axis=0)
        return ResponseCurve(rising)


def srgb_response() -> ResponseCurve:
    """Return the curve of sRGB (IEC 61966-2-1), which cameras bend at their liking."""
    value = np.arange(LEVELS) / (LEVELS - 1)
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return ResponseCurve(np.repeat(linear[:, None], 3, axis=1))


def linear_response() -> ResponseCurve:
    """Return the curve of photographs developed from raw data without a tone curve."""
    return ResponseCurve(np.repeat(np.arange(LEVELS, dtype=float)[:, None], 3, axis=1))


def response_named(
    name: str, photographs: Sequence[Photograph], exposures: Sequence[Exposure]
) -> ResponseCurve:
    """Return a response by its name: debevec, robertson, srgb, linear, or a file."""
    if name in get_args(Method):
        return recover_response(photographs, exposures, method=name)  # type: ignore[arg-type]
    if name == "srgb":
        return srgb_response()
    return linear_response() if name == "linear" else read_response(name)


def recover_response(
    photographs: Sequence[Photograph],
    exposures: Sequence[Exposure],
    *,
    method: Method = "debevec",
) -> ResponseCurve:
    """Return the response that best explains a bracket of one scene.

    Needs a scene with smooth gradients, a camera that did not move, and exposures
    that overlap, about one stop apart.

    References
    ----------
    Debevec, P. E. and Malik, J. (1997): Recovering high dynamic range radiance maps
    from photographs. SIGGRAPH. Robertson, M. A. et al. (2003): Estimation-theoretic
    approach to dynamic range enhancement using multiple exposures. Journal of
    Electronic Imaging 12(2). Both as in OpenCV.

    Raises
    ------
    InputError : fewer than two photographs, exposures that are all alike
    """
    check_bracket(photographs, exposures)
    times = np.array([exposure.relative() for exposure in exposures], dtype=np.float32)
    if np.ptp(np.log2(times)) < 1:
        raise InputError("exposures less than one stop apart; a bracket expected")
    cv2 = opencv()
    # Debevec's default of 70 points leaves curves ragged
    solver = (
        cv2.createCalibrateDebevec(samples=400, lambda_=30.0)
        if method == "debevec"
        else cv2.createCalibrateRobertson(max_iter=60)
    )
    curve = solver.process([np.ascontiguousarray(p) for p in photographs], times)
    return ResponseCurve(np.asarray(curve, dtype=float).reshape(LEVELS, 3)).monotonic()


def check_bracket(
    photographs: Sequence[Photograph], exposures: Sequence[Exposure]
) -> None:
    """Refuse brackets whose parts do not fit each other."""
    if len(photographs) < 2:
        raise InputError(f"{len(photographs)} photographs; two or more expected")
    if len(photographs) != len(exposures):
        raise InputError(
            f"{len(exposures)} exposures for {len(photographs)} photographs; one each"
            " expected"
        )
    first = photographs[0].shape
    for number, photograph in enumerate(photographs):
        if photograph.shape != first:
            raise InputError(
                f"photograph {number + 1} has {photograph.shape[1]} ×"
                f" {photograph.shape[0]} pixels; {first[1]} × {first[0]} as the first"
                " expected"
            )


def write_response(curve: ResponseCurve, path: str | Path) -> None:
    """Write a response as a table: value, red, green, blue.

    Raises
    ------
    OutputError : the file cannot be written
    """
    rows = (
        f"{value},{red:.9g},{green:.9g},{blue:.9g}"
        for value, (red, green, blue) in enumerate(curve.exposure.tolist())
    )
    write_text(path, "\n".join(["value,red,green,blue", *rows]) + "\n")


def read_response(path: str | Path) -> ResponseCurve:
    """Read a response: a table as written here, or hdrgen's .rsp polynomials.

    Raises
    ------
    InputError : the file is missing, or neither
    """
    lines = [line for line in read_text(path).splitlines() if line.strip()]
    try:
        if lines and lines[0].replace(" ", "").lower() == "value,red,green,blue":
            table = np.array([line.split(",") for line in lines[1:]], dtype=float)
            if table.shape == (LEVELS, 4):
                return ResponseCurve(table[:, 1:])
        elif len(lines) == 3:
            return _polynomials([np.array(line.split(), float) for line in lines])
    except (ValueError, InputError) as error:
        raise InputError(f"no response: {error}", file=path) from error
    raise InputError(
        "no response; 256 lines under value,red,green,blue or three polynomials"
        " expected",
        file=path,
    )


def _polynomials(lines: list[np.ndarray]) -> ResponseCurve:
    # Order, then coefficients from the highest power down, of the value over 255
    value = np.arange(LEVELS) / (LEVELS - 1)
    curves = []
    for numbers in lines:
        if numbers.size < 2 or numbers.size != int(numbers[0]) + 2:
            raise InputError(f"{numbers.size} numbers in a polynomial; its order + 2")
        curves.append(np.polyval(numbers[1:], value))
    return ResponseCurve(np.stack(curves, axis=1)).monotonic()
