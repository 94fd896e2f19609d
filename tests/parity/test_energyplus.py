"""Complex fenestration states, read and simulated by EnergyPlus itself."""

import importlib.util
import re
import subprocess
import sys
from collections import defaultdict
from dataclasses import replace

import numpy as np
import pytest

from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.scattering_matrix import ScatteringMatrix
from clerestory.energyplus.building_model import read_building_model
from clerestory.energyplus.complex_fenestration import complex_fenestration
from clerestory.energyplus.engine_run import AnnualRun, Output
from clerestory.energyplus.engine_run import simulate as simulate_year
from clerestory.energyplus.input_objects import as_idf
from clerestory.glazing.bsdf_layer import BsdfLayer
from clerestory.glazing.glazing_system import Gap, GlazingSystem
from clerestory.glazing.layer import Glass
from clerestory.glazing.optics import Optics
from clerestory.glazing.pane import two_band_pane
from clerestory.glazing.screen import WovenShade
from clerestory.glazing.stack import stack_layers
from clerestory.glazing.thermal import thermal_figures
from energy_models import BASIS, PANE, SLAT, Zone, blind

pytestmark = [
    pytest.mark.slow,
    pytest.mark.skipif(
        importlib.util.find_spec("pyenergyplus") is None,
        reason="EnergyPlus is not installed (extra energy)",
    ),
]

RUN = """
import sys
from pyenergyplus.api import EnergyPlusAPI
api = EnergyPlusAPI()
sys.exit(api.runtime.run_energyplus(api.state_manager.new_state(), sys.argv[1:]))
"""
MODEL = "energy/CmplxGlz_SingleZone_DoubleClearAir.idf"
OUTPUTS = (
    "Surface Outside Face Incident Beam Solar Radiation Rate per Area",
    "Surface Window Transmitted Beam Solar Radiation Rate",
    "Surface Window Transmitted Solar Radiation Rate",
    "Surface Window Total Glazing Layers Absorbed Shortwave Radiation Rate",
)

# A room without mass at 24 °C, with a window of 1 m², and the outdoor film of NFRC's
# summer
SUMMER = Zone(
    size=(4, 5, 3),
    window=(1.5, 2.5, 1, 2),
    materials="""
Material:NoMass,Insulation,Rough,40,0.9,0.00001,0.00001;
Material:NoMass,Board,Rough,0.2,0.9,1,1;
Construction,Wall,Insulation,Board;
Construction,Partition,Board;
Construction,Slab,Board;
""",
    use="""
Schedule:Constant,Use,Any,1;
Schedule:Constant,Heat,Any,24;
Schedule:Constant,Cool,Any,24.001;
""",
    power=0,
    air_changes=0,
)
OUTSIDE = (
    "Site:GroundReflectance,0,0,0,0,0,0,0,0,0,0,0,0;",
    "SurfaceProperty:ConvectionCoefficients,South Window,Outside,Value,15;",
)
THREE_DAYS = ("RunPeriod,Year,1,1,,12,31", "RunPeriod,Year,12,20,,12,22")


@pytest.fixture(scope="module")
def model(shared_data):
    """The single-zone model of LBNL: text before and of its complex fenestration."""
    text = (shared_data / MODEL).read_text("latin-1")
    text = text.replace("Version,9.6", "Version,25.2").replace(
        "Through: 1/8,", "Through: 1/31,"
    )
    asked = "".join(f"Output:Variable,Room 102 Window,{v},hourly;\n" for v in OUTPUTS)
    start = re.search(r"^ *Construction:ComplexFenestrationState", text, re.M).start()
    return text[:start] + asked, text[start:]


@pytest.fixture
def simulate(model, shared_data, tmp_path):
    """Function that runs a year of the model with a glazing system, or with its own."""

    def run(system, light=None):
        head, own = model
        objects = own
        if system is not None:
            light = light or stack_layers(system.layers, partition=BASIS)
            objects = as_idf(complex_fenestration(system, light, name="CFS_Glz_1"))
        (tmp_path / "in.idf").write_text(f"{head}\n{objects}", "latin-1")
        weather = shared_data / "weather" / "chicago.epw"
        words = [sys.executable, "-c", RUN, "-d", "out", "-w", weather, "in.idf"]
        done = subprocess.run(words, cwd=tmp_path, capture_output=True, text=True)
        errors = (tmp_path / "out" / "eplusout.err").read_text()
        assert done.returncode == 0, errors
        return tmp_path / "out"

    return run


def reported_u(folder):
    """Thermal transmittance in EnergyPlus' list of constructions [W/(m² K)]."""
    rows = (folder / "eplusout.eio").read_text().splitlines()
    row = next(r for r in rows if r.strip().startswith("WindowConstruction:Complex"))
    return float(row.split(",")[4])


def hourly(folder):
    """Series of the window by name of the output."""
    numbers, series = {}, defaultdict(list)
    for line in (folder / "eplusout.eso").read_text("latin-1").splitlines():
        cells = line.split(",")
        for name in OUTPUTS:
            listed = len(cells) > 3 and cells[3].startswith(f"{name} [")
            if listed and "Hourly" in line:
                numbers[cells[0]] = name
        if len(cells) == 2 and cells[0] in numbers:
            series[numbers[cells[0]]].append(float(cells[1]))
    return {name: np.array(values) for name, values in series.items()}


INSIDE, AIR = (Gap(0.012), Gap(0.05)), Gap(0.012)
SYSTEMS = {
    "air": ((PANE, PANE), (AIR,)),
    "argon": ((PANE, PANE), (Gap(0.012, {"argon": 0.9, "air": 0.1}),)),
    "blind inside": ((PANE, PANE, blind(0)), INSIDE),
    "tilted inside": ((PANE, PANE, blind(45)), INSIDE),
    "tilted outside": ((blind(45), PANE, PANE), INSIDE[::-1]),
    "closed outside": ((blind(75), PANE, PANE), INSIDE[::-1]),
    "woven": ((PANE, PANE, WovenShade(SLAT, 0.0005, 0.001)), INSIDE),
}


@pytest.mark.parametrize("name", SYSTEMS)
def test_thermal_transmittance_is_that_of_window(name, simulate):
    pytest.importorskip("pywincalc")
    system = GlazingSystem(name, *SYSTEMS[name])
    light = stack_layers(system.layers, partition=BASIS)
    shaded = any(not isinstance(layer, Glass) for layer in system.layers)
    known = light if shaded else None
    heat = thermal_figures(system.layers, system.gaps, light=known)
    assert reported_u(simulate(system, light)) == pytest.approx(heat.u, abs=0.005)


@pytest.mark.parametrize("from_above", [True, False])
def test_the_sun_comes_from_above(from_above, simulate):
    """Centres of patches are directions of travel: sunlight travels downwards."""
    down = -BASIS.centres()[:, 1]
    passes = (down if from_above else -down) > 1e-9
    values = np.broadcast_to(np.where(passes, 0.9, 0.0) / np.pi, (41, 41))
    matrices = {
        "transmission_front": values,
        "transmission_back": values,
        "reflection_front": np.zeros((41, 41)),
        "reflection_back": np.zeros((41, 41)),
    }
    layer = BsdfLayer(
        Bsdf(
            {
                (channel, part): ScatteringMatrix(np.array(value), BASIS, BASIS)
                for channel in ("visible", "solar")
                for part, value in matrices.items()
            }
        )
    )
    found = hourly(simulate(GlazingSystem("film", (layer,))))
    sunlight, through = (found[name] for name in OUTPUTS[:2])
    # The window has 8.2 m²; patches at the height of the horizon transmit nothing
    share = through.sum() / (8.2177 * sunlight.sum())
    assert 0.7 < share < 0.9 if from_above else share == 0


def published_system():
    """Two panes with the values along the normal that the published file states.

    They give 0.7207 transmitted, 0.1382 reflected, 0.0792 absorbed by the outer one
    (solar) and 0.8102 transmitted (visible).
    """
    solar, visible = Optics.alike(0.84168, 0.08396), Optics.alike(0.89930, 0.04319)
    pane = replace(
        two_band_pane("pane", solar=solar, visible=visible), thickness=0.003962
    )
    return GlazingSystem("double", (Glass(pane), Glass(pane)), (AIR,))


def test_the_published_model_with_our_matrices(model, simulate):
    """Two panes with the values along the normal that the file states."""
    _, text = model
    normal = {}
    for name in ("TfSol", "RbSol", "Tfvis", "Layer_1_fAbs"):
        start = text.index(f"CFS_Glz_1_{name},", text.index("Matrix:TwoDimension"))
        cells = re.sub(r"!.*", "", text[start:]).split(",")
        normal[name] = float(cells[3])
    system = published_system()
    light = stack_layers(system.layers, partition=BASIS)
    measure = BASIS.projected_solid_angles()[0]
    given = [normal[name] * measure for name in ("TfSol", "RbSol", "Tfvis")]
    ours = [
        light.direct_hemispherical(part, channel=channel)[0]
        for part, channel in (
            ("transmission_front", "solar"),
            ("reflection_back", "solar"),
            ("transmission_front", "visible"),
        )
    ]
    np.testing.assert_allclose(ours, given, atol=1e-4)
    outer = light.absorptance["solar", "front"][0, 0]
    assert outer == pytest.approx(normal["Layer_1_fAbs"], abs=1e-4)

    folder = simulate(None)
    theirs, u = hourly(folder), reported_u(folder)
    folder = simulate(system, light)
    with_ours = hourly(folder)
    for name, least in zip(OUTPUTS[2:], (300, 50), strict=True):
        assert theirs[name].mean() > least
        apart = np.abs(with_ours[name] - theirs[name]).mean()
        assert apart < 0.01 * theirs[name].mean()
    assert reported_u(folder) == pytest.approx(u, abs=0.001)
    heat = thermal_figures(system.layers, system.gaps)
    assert u == pytest.approx(heat.u, abs=0.005)


@pytest.mark.parametrize("ours", [False, True], ids=["published", "ours"])
def test_the_heat_gain_of_the_published_model(ours, model, shared_data, tmp_path):
    """The solar heat gain coefficient, from zone loads with the sun and without.

    The window of 1 m² in a black room without mass has NFRC's summer conditions, and
    the sun along its normal: a day of winter at the polar circle.
    """
    system = published_system()
    objects = model[1]
    if ours:
        light = stack_layers(system.layers, partition=BASIS)
        objects = as_idf(complex_fenestration(system, light, name="CFS_Glz_1"))
    path = tmp_path / "in.idf"
    text = SUMMER.text("CFS_Glz_1", objects, *OUTSIDE).replace(*THREE_DAYS)
    path.write_text(text.replace("Timestep,4", "Timestep,1"), "latin-1")
    building = read_building_model(path).objects
    weather = shared_data / "weather" / "chicago.epw"
    net = Output("Surface Window Net Heat Transfer Rate", "South Window")
    sun = Output(OUTPUTS[0], "South Window")
    load = Output("Cooling:EnergyTransfer", sum=True)
    found = []
    for watts in (783, 0):
        steady = tmp_path / f"{watts}.epw"
        steady.write_text(steady_weather(weather.read_text("latin-1"), watts))
        run = AnnualRun(building, steady, [], [net, sun, load])
        found.append(simulate_year(run)[:, 354 * 24 : 355 * 24])
    with_sun, without = found
    noon = int(np.argmax(with_sun[1]))
    assert with_sun[1, noon] == pytest.approx(783, rel=0.01)
    shgc = (with_sun[0] - without[0])[noon] / with_sun[1, noon]
    expected = thermal_figures(system.layers, system.gaps).shgc
    assert shgc == pytest.approx(expected, abs=0.005)
    # The sum of the loads of the day; the wall has a little gain of its own
    gain = (with_sun[2] - without[2]).sum() / 3600 / with_sun[1].sum()
    assert gain == pytest.approx(shgc, abs=0.01)


def steady_weather(text, watts):
    """An EPW file of 32 °C, a black sky of that temperature, and a constant sun."""
    lines = text.splitlines()
    place = lines[0].split(",")
    place[6:9] = ["65.5", "0.0", "0.0"]
    rows = [",".join(place), *lines[1:8]]
    sky = 5.6697e-8 * (32 + 273.15) ** 4
    given = {6: 32, 12: f"{sky:.2f}", 13: watts, 14: watts, 15: 0, 21: 2.75}
    for line in lines[8:]:
        cells = line.split(",")
        for column, value in given.items():
            cells[column] = str(value)
        rows.append(",".join(cells))
    return "\n".join(rows) + "\n"
