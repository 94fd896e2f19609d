"""Product information in BSDF files: all elements except the scattering data."""

from dataclasses import dataclass, field

from clerestory.brief_repr import brief


@dataclass(frozen=True)
class Geometry:
    """The geometry of a layer as text in MGF, the Materials and Geometry Format."""

    text: str  # MGF text in window coordinates: z points into the room, all z ≤ 0
    metres: float = 1.0  # length unit of the MGF text [m]
    # Line of the file where the text starts, for error messages
    line: int = field(default=1, compare=False)


@dataclass(frozen=True)
class Detail:
    """XML element that is copied unchanged, such as a conductivity."""

    name: str  # element name; "Geometry/Angle" for a child of the geometry element
    text: str  # element text
    unit: str = ""  # unit attribute; "" if not given


@dataclass(frozen=True)
class Spectra:
    """File names of the source spectrum and the detector spectrum of a channel."""

    channel: str
    source: str
    detector: str


def usual_spectra(channel: str) -> Spectra:
    """Return the spectrum file names that genBSDF and WINDOW write for a channel.

    >>> usual_spectra("visible").detector
    'ASTM E308 1931 Y.dsp'
    """
    seen = channel in ("visible", "cie-x", "cie-z", "cie-u", "cie-v")
    detector = "ASTM E308 1931 Y.dsp" if seen else "None"
    return Spectra(channel, "CIE Illuminant D65 1nm.ssp", detector)


@dataclass(frozen=True)
class Product:
    """Name, dimensions and thermal properties of a layer.

    Attributes
    ----------
    name, manufacturer, device_type : texts of the XML elements Name, Manufacturer and
        DeviceType
    thickness, width, height : dimensions [m]; None if not given
    emissivity_front, emissivity_back : hemispherical, far infrared, 0…1; None if not
        given
    geometry : geometry of the layer; None if the file contains none
    details : all other elements of the file
    spectra : file names of spectra, for channels that differ from `usual_spectra`
    """

    name: str = ""
    manufacturer: str = ""
    device_type: str = "Other"
    thickness: float | None = None
    width: float | None = None
    height: float | None = None
    emissivity_front: float | None = None
    emissivity_back: float | None = None
    geometry: Geometry | None = None
    details: tuple[Detail, ...] = ()
    spectra: tuple[Spectra, ...] = ()

    __repr__ = brief
