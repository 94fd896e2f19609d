"""Arrays and images encoded as text within a page."""

import base64
import gzip
import io

import numpy as np
from jaxtyping import Bool, Float, UInt8
from matplotlib.figure import Figure
from matplotlib.image import imsave
from PIL import Image

# Upper limit of encoded illuminance, above any daylight [lux], and step of
# log(1 + lux) between two 16-bit numbers
_BRIGHTEST = 200_000.0
CODE_STEP = np.log1p(_BRIGHTEST) / 65_535


def packed(values: np.ndarray) -> str:
    """Return an array as little-endian bytes, compressed by gzip, in base64.

    The bytes are reproducible, as the archive contains no time stamp.
    """
    little = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<"))
    return base64.b64encode(gzip.compress(little.tobytes(), 6, mtime=0)).decode()


def illuminance_codes(lux: Float[np.ndarray, "*batch"]) -> np.ndarray:
    """Encode illuminance in 16 bits, equidistant in the logarithm of 1 + lux.

    The page decodes them to a relative precision of 0.02 %.
    """
    codes = np.round(np.log1p(np.clip(lux, 0, _BRIGHTEST)) / CODE_STEP)
    return np.asarray(codes, dtype=np.uint16)


def png(
    rgb: UInt8[np.ndarray, "row column 3"],
    shown: Bool[np.ndarray, "row column"] | None = None,
) -> str:
    """Return pixels as the data URL of a PNG image, transparent where not `shown`."""
    opaque = np.ones(rgb.shape[:2], dtype=bool) if shown is None else shown
    stream = io.BytesIO()
    rgba = np.dstack([rgb, 255 * opaque.astype(np.uint8)])
    imsave(stream, rgba, format="png", metadata={"Software": ""})
    return image_address(stream.getvalue())


def figure_png(figure: Figure, *, dpi: int) -> bytes:
    """Return a figure as PNG data, which are reproducible."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=dpi, metadata={"Software": None})
    return stream.getvalue()


def jpeg(rgb: UInt8[np.ndarray, "row column 3"], *, width: int, quality: int) -> str:
    """Return an image as the data URL of a JPEG, reduced to `width` if it is wider."""
    image = Image.fromarray(rgb)
    if image.width > width:
        height = max(1, round(image.height * width / image.width))
        image = image.resize((width, height), Image.Resampling.LANCZOS)
    stream = io.BytesIO()
    image.save(stream, format="JPEG", quality=quality, optimize=True)
    return image_address(stream.getvalue(), kind="jpeg")


def image_address(content: bytes, *, kind: str = "png") -> str:
    """Return the data URL of an image file."""
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
