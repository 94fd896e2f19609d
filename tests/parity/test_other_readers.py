"""Files that Radiance or WINDOW's engine refuses, tested with these programs.

Each change of a sound file is legal XML that we read. The answer of `bsdf check` must
be that of rtrace, which renders the layer, and of pyWinCalc, which parses the file.
"""

import re
import subprocess
import sys
from dataclasses import replace

import pytest
from radiance import ENVIRONMENT

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.other_readers import READERS, check_readers
from clerestory.bsdf.product_data import Geometry, Product
from clerestory.bsdf.resample import to_trees
from clerestory.bsdf.xml_reader import read_bsdf
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems

pytest.importorskip("pywincalc")

SCENE = """void glow sky 0 0 4 1 1 1 0
sky source sky 0 0 4 0 0 1 180
void BSDF layer 6 0 file.xml 0 1 0 . 0 0
layer polygon pane 0 0 12 -9 -9 0 9 -9 0 9 9 0 -9 9 0
"""
RENDER = (
    "oconv scene.rad > scene.oct && echo 0 0 -1 0 0 1 |"
    " rtrace -h- -ab 1 -ad 256 -lw 1e-6 scene.oct"
)
PARSE = """
import sys, numpy as np, pywincalc
found = pywincalc.parse_bsdf_xml_file("file.xml").measurements
for channel in ("visible", "solar"):
    for side in ("front", "back"):
        table = getattr(getattr(found, channel), "transmittance_" + side).data
        assert np.array(table).shape == (145, 145)
"""


def layer():
    opal = lambertian(0.5, klems("full"), reflectance=0.2)
    functions = dict(opal.functions)
    functions |= {("solar", name): part for (_, name), part in functions.items()}
    product = Product(
        name="Opal", manufacturer="Maker", thickness=0.003, width=0.5, height=0.5,
        geometry=Geometry("v x = p 0 0 0", 1.0),
    )  # fmt: skip
    return replace(opal, functions=functions, product=product)


def put(pattern, text, **keywords):
    return lambda xml: re.sub(pattern, text, xml, **keywords)


def separated(by):
    return put(r"(?<=\d),(?=\d)", by)


CHANGES = {
    "nothing": lambda xml: xml,
    "FileType spaced": put("<FileType>BSDF<", "<FileType> BSDF <"),
    "FileType on its own line": put("<FileType>BSDF<", "<FileType>\n BSDF\n<"),
    "FileType LENS": put("<FileType>BSDF<", "<FileType>LENS<"),
    "FileType in small letters": put("<FileType>BSDF<", "<FileType>bsdf<"),
    "no FileType": put("<FileType>BSDF</FileType>", ""),
    "WindowElementType spaced": put(">System<", "> System <", count=1),
    "structure spaced": put(">Columns<", "> Columns <"),
    "structure in small letters": put(">Columns<", ">columns<"),
    "visible spaced": put(">Visible<", "> Visible <"),
    "visible in small letters": put(">Visible<", ">visible<"),
    "solar spaced": put(">Solar<", ">\nSolar\n<"),
    "directions spaced": put(">(Transmission \\w+)<", r"> \1 <"),
    "two spaces in directions": put(">Transmission ", ">Transmission  "),
    "bases spaced": put("AngleBasis>LBNL/Klems Full<", "AngleBasis> LBNL/Klems Full <"),
    "name of basis spaced": put(
        "BasisName>LBNL/Klems Full<", "BasisName> LBNL/Klems Full <"
    ),
    "basis of its own": put("LBNL/Klems Full", "Mine"),
    "basis of its own spaced": lambda xml: xml.replace(
        "AngleBasis>LBNL/Klems Full<", "AngleBasis> Mine <"
    ).replace("LBNL/Klems Full", "Mine"),
    "rings not quite joined": lambda xml: xml.replace(
        "LBNL/Klems Full", "Mine"
    ).replace("<LowerTheta>5<", "<LowerTheta>5.001<"),
    "no rings": put("<AngleBasis>.*?</AngleBasis>", "", flags=re.S),
    "tabs": separated("\t"),
    "spaces": separated(" "),
    "commas and tabs": separated(",\t"),
    "commas and spaces": separated(" , "),
    "two commas": put(r"(?<=\d),(?=\d)", ",,", count=1),
    "text before": lambda xml: "Recover using: wrapBSDF\n" + xml,
    "line before": lambda xml: "\n" + xml,
    "byte order mark": lambda xml: "\ufeff" + xml,
    "no declaration": lambda xml: xml.partition("?>")[2].lstrip(),
    "prefix": lambda xml: re.sub("<(/?)(?=[A-Z])", r"<\1w:", xml).replace(
        "xmlns=", "xmlns:w="
    ),
    "no namespace": put(' xmlns="[^"]*"', ""),
    "thickness in mm": put('unit="Millimeter"', 'unit="mm"'),
    "thickness in microns": put('unit="Millimeter"', 'unit="micron"'),
    "thickness in inches": put('unit="Millimeter"', 'unit="Inch"'),
    "thickness without unit": put(' unit="Millimeter"', ""),
    "thickness negative": put(">3<", ">-3<"),
    "thickness in words": put(">3<", ">thin<"),
    "thickness empty": put(">3<", "> <"),
    "thickness with a comma": put(">3<", ">3,0<"),
    "no thickness": put("<Thickness.*?</Thickness>", ""),
    "width in yards": put('(<Width) unit="Meter"', r'\1 unit="yard"'),
    "no material": put("<Material>.*?</Material>", "", flags=re.S),
    "no name": put("<Name>.*?</Name>", ""),
    "blank name": put("<Name>.*?</Name>", "<Name> </Name>"),
    "no manufacturer": put("<Manufacturer>.*?</Manufacturer>", ""),
    "empty manufacturer": put(">Maker<", "><"),
    "geometry in OBJ": put('format="MGF"', 'format="OBJ"'),
    "geometry in metres": put('(<MGFblock) unit="meter"', r'\1 unit="metre"'),
    "wavelength without unit": put(' unit="Integral"', ""),
    "wavelength unit spaced": put('unit="Integral"', 'unit=" Integral "'),
    "wavelength in microns": put('unit="Integral"', 'unit="micron"'),
    "no ScatteringDataType": put("<ScatteringDataType>.*?</ScatteringDataType>", ""),
    "no LayerNumber": put("<LayerNumber>.*?</LayerNumber>", ""),
    "solar in small letters": put(">Solar<", ">solar<"),
    "no solar": put(">Solar<", ">NIR<"),
    "Windows line ends": lambda xml: xml.replace("\n", "\r\n"),
}


# Files that we refuse ourselves
REFUSED = ("thickness negative", "geometry in metres")


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    path = tmp_path_factory.mktemp("sound") / "sound.xml"
    write_bsdf(path, layer())
    return path.read_text()


def read_by_radiance(folder):
    (folder / "scene.rad").write_text(SCENE)
    done = subprocess.run(
        RENDER, shell=True, cwd=folder, env=ENVIRONMENT, capture_output=True, text=True,
        check=False,
    )  # fmt: skip
    seen = done.stdout.split()
    return bool(seen) and float(seen[0]) == pytest.approx(0.5, rel=2e-3)


def read_by_wincalc(folder):
    done = subprocess.run(
        [sys.executable, "-c", PARSE], cwd=folder, capture_output=True, check=False
    )
    return done.returncode == 0


def assert_answers(folder):
    found = {finding.where: finding for finding in check_readers(folder / "file.xml")}
    expected_to_read = {reader: reader not in found for reader in READERS}
    true = dict(
        zip(READERS, (read_by_radiance(folder), read_by_wincalc(folder)), strict=True)
    )
    assert expected_to_read == true
    assert all(re.match(r"line \d+: .* expected$", f.what) for f in found.values())


@pytest.mark.parametrize("change", CHANGES)
def test_the_answer_is_that_of_the_programs(change, sound, tmp_path):
    text = CHANGES[change](sound)
    assert (text == sound) == (change == "nothing")
    (tmp_path / "file.xml").write_text(text, newline="")
    if change in REFUSED:
        with pytest.raises(InputError, match="expected"):
            read_bsdf(tmp_path / "file.xml")
    else:
        read_bsdf(tmp_path / "file.xml")
    assert_answers(tmp_path)


def test_trees_are_for_radiance_alone(tmp_path):
    trees = to_trees(layer(), halvings=2)
    write_bsdf(tmp_path / "file.xml", trees)
    assert_answers(tmp_path)
    for text in ("TensorTree4", "LBNL/Shirley-Chiu"):
        xml = (tmp_path / "file.xml").read_text()
        (tmp_path / "file.xml").write_text(xml.replace(f">{text}<", f"> {text} <"))
        assert_answers(tmp_path)
        (tmp_path / "file.xml").write_text(xml)


@pytest.mark.filterwarnings("ignore:.*times the incident flux")
def test_published_files_are_read_by_radiance(shared_data):
    """All that Radiance's library loads (`test_bsdf_files.py`): no false alarm."""
    for path in (shared_data / "bsdf").rglob("*.xml"):
        if path.parent.name == "bsdfxmlparser" or path.stem.endswith("BSDFt"):
            continue
        refused = {finding.where for finding in check_readers(path)}
        assert "Radiance" not in refused, path.name
