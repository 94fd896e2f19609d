"""Arrays and images encoded as text within a page."""

import base64
import gzip
import io

import numpy as np
from jaxtyping import Float, UInt8
from matplotlib.image import imsave
from PIL import Image

from clerestory.report.colour import ColourScale

# Upper limit of encoded illuminance, above any daylight [lux]
_BRIGHTEST = 200_000.0
_CODES = 65_535


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
    step = np.log1p(_BRIGHTEST) / _CODES
    codes = np.round(np.log1p(np.clip(lux, 0, _BRIGHTEST)) / step)
    return np.asarray(codes, dtype=np.uint16)


def code_step() -> float:
    """Return the step of `log(1 + lux)` between two codes."""
    return float(np.log1p(_BRIGHTEST) / _CODES)


def picture(values: Float[np.ndarray, "bin day"], scale: ColourScale) -> str:
    """Return a false-colour image as data URL; row 0 at the bottom, NaN transparent."""
    known = np.isfinite(values)
    rgba = np.zeros((*values.shape, 4), dtype=np.uint8)
    rgba[..., :3] = scale.colours(np.where(known, values, scale.low))
    rgba[..., 3] = 255 * known
    return png(rgba[::-1])


def png(rgba: UInt8[np.ndarray, "row column 4"]) -> str:
    """Return pixels as the data URL of a PNG image."""
    stream = io.BytesIO()
    imsave(stream, rgba, format="png", metadata={"Software": ""})
    return png_address(stream.getvalue())


def png_address(content: bytes) -> str:
    """Return PNG data as a data URL."""
    return "data:image/png;base64," + base64.b64encode(content).decode()


def jpeg(rgb: UInt8[np.ndarray, "row column 3"], *, width: int, quality: int) -> str:
    """Return an image as the data URL of a JPEG, reduced to `width` if it is wider."""
    picture = Image.fromarray(rgb)
    if picture.width > width:
        height = max(1, round(picture.height * width / picture.width))
        picture = picture.resize((width, height), Image.Resampling.LANCZOS)
    stream = io.BytesIO()
    picture.save(stream, format="JPEG", quality=quality, optimize=True)
    return "data:image/jpeg;base64," + base64.b64encode(stream.getvalue()).decode()
