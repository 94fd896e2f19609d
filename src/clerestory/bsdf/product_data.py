"""What a BSDF file says about the product itself, besides its scattering."""

from dataclasses import dataclass, field


@dataclass(frozen=True)
class Geometry:
    """The shape of a layer as a text in MGF, the Materials and Geometry Format.

    `clerestory.radiance.bsdf_package.layer_geometry` makes a scene of it.

    Attributes
    ----------
    text : in the frame of the BSDF; z points into the room, nothing is above 0
    metres : length of its unit [m]
    line : where it starts in its file, for messages
    """

    text: str
    metres: float = 1.0
    line: int = field(default=1, compare=False)


@dataclass(frozen=True)
class Detail:
    """Something a file says that is kept as it is, such as a conductivity.

    Attributes
    ----------
    name : of its element; "Geometry/Angle" for one of the geometry
    text, unit : as in the file; unit "" if not given
    """

    name: str
    text: str
    unit: str = ""


@dataclass(frozen=True)
class Spectra:
    """Light source and detector that a channel was weighted with, by their files."""

    channel: str
    source: str
    detector: str


def usual_spectra(channel: str) -> Spectra:
    """Return what genBSDF and WINDOW write for a channel.

    >>> usual_spectra("visible").detector
    'ASTM E308 1931 Y.dsp'
    """
    seen = channel in ("visible", "cie-x", "cie-z", "cie-u", "cie-v")
    detector = "ASTM E308 1931 Y.dsp" if seen else "None"
    return Spectra(channel, "CIE Illuminant D65 1nm.ssp", detector)


@dataclass(frozen=True)
class Product:
    """Name and dimensions of a glazing or shading layer.

    Attributes
    ----------
    name, manufacturer, device_type : as in the file
    thickness, width, height : dimensions [m]; None where the file says nothing, or 0
    emissivity_front, emissivity_back : far-infrared emissivity, 0…1; None if not said
    geometry : its shape; None if the file has none
    details : what else the file says
    spectra : of channels whose spectra are not the usual ones
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
