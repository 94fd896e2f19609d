"""BSDFs, goniophotometer files and glazing products."""

import importlib
import json
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
from reader import Reader
from workbook import workbook

from clerestory.bsdf.bsdf import Bsdf
from clerestory.errors import InputError
from sample_files import PRODUCT

DATA = Path(__file__).parents[1] / "data"


MGF = (
    "m white =\n\trd 0.7\nv a =\n\tp 0 0 0\n\tn 0 0 1\nxf -a 3 -t 0 0 1\nsph a 1\nxf\n"
)


def layer_with_geometry() -> Bsdf:
    """Return a pane of five patches with the geometry of a blind."""
    analytic = importlib.import_module("clerestory.bsdf.analytic")
    klems = importlib.import_module("clerestory.hemisphere.klems")
    data = importlib.import_module("clerestory.bsdf.product_data")
    limits = np.array([0.0, 30, 90])
    rings = klems.from_rings("Few", limits_deg=limits, count=np.array([1, 4]))
    about = data.Product(
        "Pane", "Nobody", "Other", 0.01, 1, 2, geometry=data.Geometry(MGF)
    )
    return replace(analytic.thin_pane(0.9, rings), product=about)


def _bsdfs(folder: Path) -> list[bytes]:
    resample = importlib.import_module("clerestory.bsdf.resample")
    writer = importlib.import_module("clerestory.bsdf.xml_writer")
    pane = layer_with_geometry()
    writer.write_bsdf(folder / "matrix.xml", pane)
    writer.write_bsdf(folder / "tree.xml", resample.to_trees(pane, halvings=2))
    made = [(folder / name).read_bytes() for name in ("matrix.xml", "tree.xml")]
    rows = made[0].replace(b">Columns<", b">Rows<")
    return [*made, rows, (DATA / "five_patches.xml").read_bytes()]


POINTS = "0 0 .5\n10 90 .4\n20 180 .3\n30 200 .2\n40 270 .1\n"
PABOPTO = (
    '#sample_name "glass"\n#format: theta phi BRDF\n#upphi 90\n#incident_angle 30 20\n'
    + POINTS
)
COLUMNS = "theta_i,phi_i,theta_s,phi_s,brdf\n" + "".join(
    "30,20," + line.replace(" ", ",") + "\n" for line in POINTS.splitlines()
)
VIAVI = "!!EDS 30-200   RPC\n!!BSDF Data\n30 200\n" + POINTS
FRED = "type bsdf_data\nformat angles=deg bsdf=value scale=1\n30 200\n" + POINTS
ASTM = "TITLE glass\nVARS theta_i,phi_i,theta_s,phi_s,BRDF\n.5,.3,0,0,.5\n"
ASTM += ".5,.3,.2,1,.4\n.5,.3,.3,2,.4\n.5,.3,.4,3,.4\n"
TABULAR = (
    "Source Measured\nSymmetry PlaneSymmetrical\nSpectralContent Monochrome\n"
    "ScatterType BRDF\nSampleRotation 1\n0\nAngleOfIncidence 1\n30\n"
    "ScatterAzimuth 3\n0 90 180\nScatterRadial 3\n0 10 30\n\nMonochrome\n"
    "DataBegin\nTIS 0.1\n5 4 3\n5 2 1\n5 0.5 0.2\nDataEnd\n"
)

OPTICS_FILE = (
    "{ Units, Wavelength Units } SI Microns\n{ Thickness } 6.0\n{ Conductivity } 1.0\n"
    "{ IR Transmittance } TIR= 0.01\n{ Emissivity, front back } Emis= 0.84 0.03\n"
    "{ Product Name: Test coated glass }\n{ NFRC ID: 77 }\n{ Type: Coated }\n"
    "{ Coated Side: Back }\n300.0 0.10 0.20 0.30\n2500.0 0.50 0.30 0.40\n"
)
GEOMETRY = {"slat_width": 16.0, "slat_spacing": 12.0, "slat_tilt": 45.0}
GEOMETRY |= {"slat_curvature": 10.0, "number_of_segments": 5, "tilt_angle": 45.0}
SHADE = {
    "name": "shade",
    "type": "shading",
    "composition": [{"child_product": PRODUCT, "extra_data": {"geometry": GEOMETRY}}],
}
SYSTEM = """name = "Double glazing with an inner blind"
[[layer]]
file = "a.json"
flipped = false
[[gap]]
thickness_mm = 12.7
gases = { argon = 0.9, air = 0.1 }
[[layer]]
file = "a.json"
[[gap]]
thickness_mm = 50
[[layer]]
venetian = { material = "a.json", width_mm = 25, spacing_mm = 20, tilt_deg = 45 }
"""
BLIND = 'kind = "venetian"\nslat_width = 0.08\nspacing = 0.072\ntilt_deg = 45\n'
BLIND += "rise = 0.002\n"


# ------------------------------------- Readers -------------------------------------
def _judged(function: Callable[[Path], Bsdf], path: Path) -> object:
    # What is read is finite, at least 0, and can be integrated and written
    bsdf = function(path)
    rng = np.random.default_rng(1)
    incident, leaving = rng.normal(size=(2, 16, 3))
    incident /= np.linalg.norm(incident, axis=1, keepdims=True)
    leaving /= np.linalg.norm(leaving, axis=1, keepdims=True)
    for part in bsdf.functions.values():
        found = part.evaluate(incident, leaving), part.hemispherical(incident[:4])
        for numbers in (*found, part.extrema()):
            assert np.all(np.isfinite(numbers)), "a value that is not finite"
            assert np.min(numbers) >= 0, "a negative value"
    geometry = importlib.import_module("clerestory.radiance.bsdf_package")
    with suppress(InputError):
        geometry.layer_geometry(bsdf)
    if path.stat().st_size % 10 == 0:
        again = path.with_name("again.xml")
        importlib.import_module("clerestory.bsdf.xml_writer").write_bsdf(again, bsdf)
        function(again)
    return bsdf


def _insertion(folder: Path) -> list[bytes]:
    made = _bsdfs(folder)
    (folder / "source.xml").write_bytes(made[0])
    return [made[0]]


def _inserted(function: Callable[..., object], path: Path) -> object:
    output = path.with_name("out.xml")
    return function(path.with_name("source.xml"), path, output=output)


def _fits(folder: Path) -> list[bytes]:
    text = ASTM_SCANS
    (folder / "scans.astm").write_text(text)
    read = importlib.import_module("clerestory.gonio.measurement_files")
    fitted = importlib.import_module("clerestory.gonio.fitted_measurement")
    storage = importlib.import_module("clerestory.gonio.fit_storage")
    (measured,) = read.read_measurement(folder / "scans.astm")
    storage.write_fits(folder / "seed.nc", [fitted.fit_measurement(measured)])
    return [(folder / "seed.nc").read_bytes()]


def _fit_used(function: Callable[..., object], path: Path) -> object:
    angles = importlib.import_module("clerestory.gonio.angles")
    source, leaving = (
        angles.from_degrees(np.array([t, 20.0]), np.array([10.0, 90])) for t in (12, 40)
    )
    return [fit.interpolant.evaluate(source, leaving) for fit in function(path)]


def sealed(data: bytes) -> bytes:
    """Return a damaged NetCDF file of this package with a valid checksum."""
    netcdf = importlib.import_module("clerestory.matrix.netcdf")
    body = data[: -netcdf.SEAL_LENGTH]
    return body + netcdf.seal(memoryview(body))


ASTM_SCANS = "TITLE film\nVARS theta_i,phi_i,theta_s,phi_s,BRDF\n" + "".join(
    f"{i},{j},{e},{p},{0.3 * np.cos(e - i) ** 8 + 0.05:.4f}\n"
    for i, j in ((0.0, 0.0), (0.6, 0.0), (1.1, 0.0))
    for e in np.linspace(0.05, 1.35, 6).round(3)
    for p in np.linspace(0, 5.5, 8).round(3)
)
_GONIO = "gonio.measurement_files:read_measurement"


def _rt300s(_: Path) -> list[bytes]:
    rows = {"Azimuth": [], "Incidence": [], "Receive": [], "RT": []}
    for azimuth in (-90.0, 0.0):
        for receive in (-40.0, 0.0, 30.0, 60.0):
            for name, value in zip(rows, (azimuth, 30.0, receive, 0.4), strict=True):
                rows[name].append(value)
    return [workbook(rows)]


BUILDING = """{
"GlobalGeometryRules": {"R": {"coordinate_system": "Relative"}},
"Building": {"B": {"north_axis": 30}},
"Zone": {"Office": {"direction_of_relative_north": 15.0}},
"BuildingSurface:Detailed": {"Wall": {"zone_name": "Office"}},
"Construction": {"clear": {"outside_layer": "Pane"}},
"FenestrationSurface:Detailed": {"Pane": {
"building_surface_name": "Wall", "multiplier": 2.0,
"vertex_1_x_coordinate": 1, "vertex_1_y_coordinate": 0, "vertex_1_z_coordinate": 2.5,
"vertex_2_x_coordinate": 1, "vertex_2_y_coordinate": 0, "vertex_2_z_coordinate": 1,
"vertex_3_x_coordinate": 3, "vertex_3_y_coordinate": 0, "vertex_3_z_coordinate": 1
}}}
"""


def _window(found, path):
    return found(path).window("Pane"), found(path).constructions()


READERS = {
    "building": Reader(
        "energyplus.building_model:read_building_model",
        "m.epJSON",
        (BUILDING,),
        use=_window,
    ),
    "bsdf": Reader("bsdf.xml_reader:read_bsdf", "b.xml", make=_bsdfs, use=_judged),
    "bsdf template": Reader(
        "bsdf.xml_insertion:insert_blocks", "b.xml", make=_insertion, use=_inserted
    ),
    "pabopto": Reader(_GONIO, "a.txt", (PABOPTO,)),
    "columns": Reader(_GONIO, "a.csv", (COLUMNS,)),
    "viavi": Reader(_GONIO, "a.txt", (VIAVI,)),
    "fred": Reader(_GONIO, "a.txt", (FRED,)),
    "astm": Reader(_GONIO, "a.astm", (ASTM,)),
    "zemax": Reader(_GONIO, "a.bsdf", (TABULAR,)),
    "rt300s": Reader(_GONIO, "a.xls", make=_rt300s),
    "fits": Reader(
        "gonio.fit_storage:read_fits",
        "f.nc",
        make=_fits,
        use=_fit_used,
        sealed=sealed,
    ),
    "optics file": Reader("library.layer_source:read_layer", "a.dat", (OPTICS_FILE,)),
    "igsdb": Reader(
        "library.layer_source:read_layer",
        "a.json",
        (json.dumps(PRODUCT), json.dumps(SHADE)),
    ),
    "catalogue": Reader(
        "glazing.layer_files:read_catalogue",
        "a.json",
        (json.dumps(PRODUCT),),
        use=lambda function, path: function(path.parent),
    ),
    "glazing system": Reader(
        "library.system_file:read_system",
        "g.toml",
        (SYSTEM,),
        beside={"a.json": json.dumps(PRODUCT)},
    ),
    "parameters": Reader(
        "bsdfgen.system_catalogue:parse_parameters",
        "p.txt",
        ("slat_width=0.08,tilt_deg=45,reflectance=0.6/0.5/0.4,shape=round",),
        use=lambda function, path: function(path.read_text("latin-1")),
    ),
    "parametric system": Reader(
        "bsdfgen.system_catalogue:read_system", "s.toml", (BLIND,)
    ),
}
