"""What a BSDF file says about the product itself, besides its scattering."""

from dataclasses import dataclass


@dataclass(frozen=True)
class Product:
    """Name and dimensions of a glazing or shading layer.

    Attributes
    ----------
    name, manufacturer, device_type : as in the file
    thickness, width, height : dimensions [m]; None where the file does not say
    emissivity_front, emissivity_back : far-infrared emissivity, 0…1; None if not said
    """

    name: str = ""
    manufacturer: str = ""
    device_type: str = "Other"
    thickness: float | None = None
    width: float | None = None
    height: float | None = None
    emissivity_front: float | None = None
    emissivity_back: float | None = None
