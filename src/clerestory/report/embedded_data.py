"""Arrays and images encoded as text within a page."""

import base64
import gzip
import io

import numpy as np
from jaxtyping import Bool, Float, UInt8
from matplotlib.figure import Figure
from matplotlib.image import imsave
from PIL import Image

# Largest illuminance that can be encoded, above any daylight [lux]; step of
# log(1 + lux) between successive 16-bit codes
BRIGHTEST = 200_000.0
CODE_STEP = np.log1p(BRIGHTEST) / 65_535


def packed(values: np.ndarray) -> str:
    """Return an array as little-endian bytes, compressed by gzip, in base64.

    The result is reproducible, as the gzip header contains no time stamp.
    """
    little = np.ascontiguousarray(values).astype(values.dtype.newbyteorder("<"))
    return base64.b64encode(gzip.compress(little.tobytes(), 6, mtime=0)).decode()


def illuminance_codes(
    lux: Float[np.ndarray, "*batch"], *, step: float = CODE_STEP
) -> np.ndarray:
    """Encode illuminance [lux] in 16 bits, in equal steps of log(1 + lux).

    With the default step, the relative error of decoded values is at most 0.02 % above
    1 lux. NaN and negative values, noise of the direct correction, are encoded as 0.
    """
    known = np.nan_to_num(lux, nan=0.0)
    codes = np.round(np.log1p(np.clip(known, 0, BRIGHTEST)) / step)
    return np.asarray(codes, dtype=np.uint16)


def png(
    rgb: UInt8[np.ndarray, "row column 3"],
    shown: Bool[np.ndarray, "row column"] | None = None,
) -> str:
    """Return sRGB pixels as a PNG data URL, transparent where `shown` is false."""
    opaque = np.ones(rgb.shape[:2], dtype=bool) if shown is None else shown
    stream = io.BytesIO()
    rgba = np.dstack([rgb, 255 * opaque.astype(np.uint8)])
    imsave(stream, rgba, format="png", metadata={"Software": ""})
    return image_address(stream.getvalue())


def figure_png(figure: Figure, *, dpi: int) -> bytes:
    """Return a figure as PNG data without metadata, which makes it reproducible."""
    stream = io.BytesIO()
    figure.savefig(stream, format="png", dpi=dpi, metadata={"Software": None})
    return stream.getvalue()


def jpeg(rgb: UInt8[np.ndarray, "row column 3"], *, width: int, quality: int) -> str:
    """Return an image as the data URL of a JPEG, reduced to `width` if it is wider."""
    return image_address(jpeg_bytes(rgb, width=width, quality=quality), kind="jpeg")


def jpeg_bytes(
    rgb: UInt8[np.ndarray, "row column 3"], *, width: int, quality: int
) -> bytes:
    """Return an image as JPEG data, reduced to `width` [pixels] if it is wider."""
    image = Image.fromarray(rgb)
    if image.width > width:
        height = max(1, round(image.height * width / image.width))
        image = image.resize((width, height), Image.Resampling.LANCZOS)
    stream = io.BytesIO()
    image.save(stream, format="JPEG", quality=quality, optimize=True)
    return stream.getvalue()


def image_address(content: bytes, *, kind: str = "png") -> str:
    """Return the content of an image file as a data URL."""
    return f"data:image/{kind};base64,{base64.b64encode(content).decode()}"
