"""Small BSDF files, built in the test so that every fault can be put into them."""

from collections.abc import Callable

import pytest

RINGS = ((0, 30, 1), (30, 90, 4))


def basis_xml(name="Custom", rings=RINGS):
    blocks = "".join(
        f"<AngleBasisBlock><Theta>{(low + high) / 2}</Theta><nPhis>{count}</nPhis>"
        f"<ThetaBounds><LowerTheta>{low}</LowerTheta><UpperTheta>{high}</UpperTheta>"
        "</ThetaBounds></AngleBasisBlock>\n"
        for low, high, count in rings
    )
    return f"<AngleBasis><AngleBasisName>{name}</AngleBasisName>\n{blocks}</AngleBasis>"


def block_xml(
    data,
    direction="Transmission Front",
    wavelength="Visible",
    row="Custom",
    column=None,
):
    return f"""<WavelengthData>
<LayerNumber>System</LayerNumber><Wavelength unit="Integral">{wavelength}</Wavelength>
<WavelengthDataBlock>
<WavelengthDataDirection>{direction}</WavelengthDataDirection>
<ColumnAngleBasis>{column or row}</ColumnAngleBasis>
<RowAngleBasis>{row}</RowAngleBasis>
<ScatteringData>{data}</ScatteringData>
</WavelengthDataBlock>
</WavelengthData>"""


@pytest.fixture(scope="session")
def bsdf_xml() -> Callable[..., str]:
    """Text of a BSDF file; blocks are the arguments of `block_xml`, or text."""

    def build(*blocks, bases=None, structure="Columns", head="", extra=""):
        body = "\n".join(b if isinstance(b, str) else block_xml(**b) for b in blocks)
        return f"""{head}<?xml version="1.0" encoding="UTF-8"?>
<WindowElement xmlns="http://windows.lbl.gov">
<WindowElementType>System</WindowElementType>
<Optical><Layer>
<Material><Name>Test layer</Name><Manufacturer>Nobody</Manufacturer>
<Thickness unit="Millimeter">25</Thickness><DeviceType>Other</DeviceType></Material>
<DataDefinition><IncidentDataStructure>{structure}</IncidentDataStructure>
{basis_xml() if bases is None else bases}</DataDefinition>
{body}{extra}
</Layer></Optical>
</WindowElement>
"""

    return build


@pytest.fixture(scope="session")
def basis():
    """Text of an AngleBasis element."""
    return basis_xml


@pytest.fixture
def write(tmp_path):
    """Write text or bytes to a file and return its path."""

    def to_file(content, name="layer.xml"):
        path = tmp_path / name
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return to_file
