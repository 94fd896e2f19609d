"""Camera response curves: exposure as a function of pixel value.

A curve applies to one camera with fixed settings. It is recovered once from an exposure
bracket and saved, or read from an .rsp file of hdrgen.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Literal, get_args

import numpy as np
from jaxtyping import Float

from clerestory.checks import has_shape, require, same_length
from clerestory.errors import InputError
from clerestory.files import read_text, write_text
from clerestory.image.opencv import opencv
from clerestory.image.photograph import Exposure, Photograph
from clerestory.image.picture import same_size

Method = Literal["debevec", "robertson"]

LEVELS = 256

# Pixel value at which response curves are normalised to 1
_MIDDLE = 128


@dataclass(frozen=True, eq=False)
class ResponseCurve:
    """Relative exposure as a function of pixel value, for red, green and blue.

    Attributes
    ----------
    exposure : relative exposure at the pixel values 0…255, normalised to 1 at 128
    """

    exposure: Float[np.ndarray, "256 3"]

    def __post_init__(self) -> None:
        curve = np.asarray(self.exposure, dtype=float)
        has_shape(curve, (LEVELS, 3), "camera response (pixel values × channels)")
        require(
            np.isfinite(curve).all() and (curve[_MIDDLE] > 0).all(),
            "the camera response is not finite, or not positive at value 128",
        )
        object.__setattr__(self, "exposure", curve / curve[_MIDDLE])

    def monotonic(self) -> "ResponseCurve":
        """Return a non-decreasing curve: the running maximum of this curve."""
        return ResponseCurve(np.maximum.accumulate(np.maximum(self.exposure, 0)))


def srgb_response() -> ResponseCurve:
    """Return the sRGB curve (IEC 61966-2-1), which approximates most cameras."""
    value = np.arange(LEVELS) / (LEVELS - 1)
    linear = np.where(value <= 0.04045, value / 12.92, ((value + 0.055) / 1.055) ** 2.4)
    return ResponseCurve(np.stack([linear] * 3, axis=1))


def linear_response() -> ResponseCurve:
    """Return the linear curve, for raw photographs developed without a tone curve."""
    return ResponseCurve(np.stack([np.arange(LEVELS, dtype=float)] * 3, axis=1))


def response_named(
    name: str, photographs: Sequence[Photograph], exposures: Sequence[Exposure]
) -> ResponseCurve:
    """Return the curve `name`: debevec, robertson, srgb, linear, or a file path."""
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
    """Return the response curve that best fits an exposure bracket of one scene.

    The scene must have smooth gradients, the camera must not move, and exposures should
    be about one stop apart.

    Sources: Debevec, P. E. and Malik, J. (1997): Recovering high dynamic range radiance
    maps from photographs. SIGGRAPH. Robertson, M. A. et al. (2003):
    Estimation-theoretic approach to dynamic range enhancement using multiple exposures.
    Journal of Electronic Imaging 12(2). Both are implemented by OpenCV.
    """
    check_bracket(photographs, exposures)
    times = np.array([exposure.relative() for exposure in exposures], dtype=np.float32)
    require(
        np.ptp(np.log2(times)) >= 1,
        "the exposures are less than one stop apart; one stop or more expected",
    )
    cv2 = opencv()
    # The default of 70 sample points gives noisy curves
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
    """Check the number of exposures, and the sizes of the photographs of a bracket."""
    require(
        len(photographs) >= 2,
        f"number of photographs: {len(photographs)}; two or more expected",
    )
    same_length(exposures, photographs, "exposures", "photographs")
    for number, photograph in enumerate(photographs, start=1):
        same_size(photograph, photographs[0], f"photograph {number}")


def write_response(curve: ResponseCurve, path: str | Path) -> None:
    """Write a response curve as a CSV table: pixel value, red, green, blue."""
    rows = (
        f"{value},{red:.9g},{green:.9g},{blue:.9g}"
        for value, (red, green, blue) in enumerate(curve.exposure.tolist())
    )
    write_text(path, "\n".join(["value,red,green,blue", *rows]) + "\n")


def read_response(path: str | Path) -> ResponseCurve:
    """Read a response curve from a file of `write_response` or .rsp file of hdrgen."""
    lines = [line for line in read_text(path).splitlines() if line.strip()]
    try:
        if lines and lines[0].replace(" ", "").lower() == "value,red,green,blue":
            table = np.array([line.split(",") for line in lines[1:]], dtype=float)
            if table.shape == (LEVELS, 4):
                return ResponseCurve(table[:, 1:])
        elif len(lines) == 3:
            return _polynomials([np.array(line.split(), float) for line in lines])
    except (ValueError, InputError) as error:
        raise InputError(f"not a camera response: {error}", file=path) from error
    raise InputError(
        "not a camera response; 256 lines below value,red,green,blue, or three"
        " polynomials, expected",
        file=path,
    )


def _polynomials(lines: list[np.ndarray]) -> ResponseCurve:
    # Each line: degree, then coefficients of pixel value / 255, highest power first
    value = np.arange(LEVELS) / (LEVELS - 1)
    curves = []
    for numbers in lines:
        require(
            2 <= numbers.size == numbers[0] + 2,
            f"a line has {numbers.size} numbers; degree N of a polynomial and its N + 1"
            " coefficients expected",
        )
        curves.append(np.polyval(numbers[1:], value))
    return ResponseCurve(np.stack(curves, axis=1)).monotonic()
