"""Error of coarse spectral bands in a coloured room: illuminance, melanopic EDI, CCT.

    python benchmarks/spectral_bands.py [--samples 65536] [--write FILE]

The demo room with red carpet and oak desks, behind clear double glazing without and
with a blue filter, under six skies of a clear and an overcast day. Light at four eyes
in 81 bands is the reference for coarser bands. All colours are those of the spectra in
this file.
"""

import argparse
import tempfile
import time
from dataclasses import replace
from importlib import resources
from pathlib import Path

import numpy as np
from duel import stamp

import clerestory as cl
from clerestory.bands import Bands
from clerestory.spectra import Spectrum
from clerestory.spectral.band_sets import gives
from clerestory.spectral.colour_temperature import colour_temperature, tristimulus

DEMO = resources.files("clerestory") / "demo"

# Spectra typical of the materials: reflectances, and transmittance of the blue glass
NM = np.array([380, 420, 460, 500, 540, 580, 620, 660, 700, 740, 780], dtype=float)
SPECTRA = {
    "floor": (0.04, 0.04, 0.04, 0.04, 0.05, 0.10, 0.30, 0.42, 0.48, 0.52, 0.55),
    "desk": (0.12, 0.17, 0.22, 0.28, 0.36, 0.44, 0.50, 0.54, 0.57, 0.59, 0.61),
}
BLUE = (0.50, 0.62, 0.64, 0.58, 0.50, 0.42, 0.38, 0.40, 0.48, 0.58, 0.60)

# Band sets by the name in the table
CHOICES: dict[str, Bands] = {
    "81 bands": cl.band_set("81"),
    "20 bands": cl.band_set("20"),
    "9 bands": cl.band_set("9"),
    "3 bands": cl.wavelength_bands([380, 480, 588, 780]),
    "melanopic+photopic": cl.band_set("melanopic+photopic"),
}

# A clear and an overcast day: hour, direct normal and diffuse horizontal irradiance
WEATHER = """place Greensboro
latitude 36.10
longitude 79.95
time_zone 75
site_elevation 273
weather_data_file_units 1
3 21 7.5 300 60
3 21 12.5 850 110
3 21 16.5 600 90
3 22 7.5 0 50
3 22 12.5 0 260
3 22 16.5 0 120
"""


def main() -> None:
    """Trace the room in all band sets, and print or write the table."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--samples", type=int, default=1 << 15)
    parser.add_argument("--write", type=Path)
    given = parser.parse_args()
    text = page(given.samples)
    if given.write:
        given.write.write_text(text, encoding="utf-8")
    print(text)


def page(samples: int) -> str:
    """Return the page with a table for each glass."""
    found = {name: light(bands, samples) for name, bands in CHOICES.items()}
    lines = [
        "# Error of coarse spectral bands",
        "",
        f"{stamp()}. Made by `benchmarks/spectral_bands.py`.",
        "",
        "The demo room with red carpet and oak desks, four eyes, six skies of a clear"
        " and an overcast day.",
        "Root mean square and largest difference from 81 bands (5 nm). Band sets have"
        " the same seeds, so",
        "that most of the standard error of illuminance"
        f" ({max(one[3] for one in found.values()):.1%} on average) cancels.",
    ]
    for number, glass in enumerate(("Clear glazing", "With blue-tinted glass")):
        lines += ["", f"## {glass}", "", *table(found, number)]
    return "\n".join([*lines, ""])


def table(found: dict[str, tuple], glass: int) -> list[str]:
    """Return the rows of a table: differences from 81 bands behind one glass."""
    lux, edi, kelvin, _, _ = found["81 bands"]
    rows = [
        "| | lux | melanopic EDI | CCT | processor time of V |",
        "|---|---|---|---|---|",
        f"| 81 bands | {span(lux[glass])} lux | {span(edi[glass])} lux"
        f" | {span(kelvin[glass])} K | {found['81 bands'][4]:.1f} s |",
    ]
    for name, (own_lux, own_edi, own_kelvin, _, seconds) in found.items():
        if name == "81 bands":
            continue
        cct = "not defined"
        if own_kelvin is not None:
            off = np.abs(own_kelvin[glass] - kelvin[glass])
            cct = f"{np.sqrt(np.mean(off**2)):.0f} K, {off.max():.0f} K"
        rows.append(
            f"| {name} | {off_percent(own_lux[glass], lux[glass])}"
            f" | {off_percent(own_edi[glass], edi[glass])} | {cct} | {seconds:.1f} s |"
        )
    return rows


def light(bands: Bands, samples: int) -> tuple:
    """Return illuminance, EDI, CCT by (glass, eye, hour), error, and seconds of V."""
    spectra = {name: Spectrum(NM, np.array(value)) for name, value in SPECTRA.items()}
    scene = cl.read_rad(
        DEMO / "materials.rad", DEMO / "room.rad", DEMO / "workstation.rad"
    )
    room = cl.in_bands(scene, bands, spectra=spectra)
    site = cl.in_bands(cl.read_rad(DEMO / "materials.rad", DEMO / "room.rad"), bands)
    window, eyes = (
        cl.read_window(DEMO / "window.rad"),
        cl.read_sensors(DEMO / "eyes.pts"),
    )
    begin = time.process_time()
    view = cl.view_matrix(room, window, sensors=eyes, samples=samples)
    seconds = time.process_time() - begin
    daylight = cl.daylight_matrix(site, window, subdivision=1, samples=4096)
    clear = cl.read_bsdf(DEMO / "double_pane.xml").transmission_matrix()
    tint = cl.band_means(Spectrum(NM, np.array(BLUE)), bands)
    blue = replace(clear, values=clear.values[:1] * tint[:, None, None], bands=bands)
    light_of_sky = sky(bands)
    through = [(view @ T @ daylight @ light_of_sky).rgb() for T in (clear, blue)]
    values = np.stack([each.values for each in through], axis=1)
    lux = bands.photometric(values, axis=0)
    error = np.sqrt(
        sum(
            np.square(bands.photometric(part, axis=0)) for part in through[1].components
        )
    )
    kelvin = None
    if gives_colour(bands):
        kelvin = colour_temperature(tristimulus(values, bands)).kelvin
    edi = cl.equivalent_daylight_illuminance(values, bands)
    return lux, edi, kelvin, float((error / lux[1]).mean()), seconds


def gives_colour(bands: Bands) -> bool:
    """Whether the bands are intervals, from which tristimulus values follow."""
    return bands.limits_nm is not None and gives(bands, "photopic")


def sky(bands: Bands):
    """Return the skies and suns of six hours in spectral bands."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder, "hours.wea")
        file.write_text(WEATHER, encoding="utf-8")
        weather = cl.read_weather(file)
    return cl.sky_matrix(
        weather, subdivision=1, bands=bands, daylight=cl.DaylightSpectra()
    )


def off_percent(found: np.ndarray, expected: np.ndarray) -> str:
    """Return root mean square and largest relative difference."""
    off = np.abs(found / expected - 1)
    return f"{np.sqrt(np.mean(off**2)):.1%}, {off.max():.1%}"


def span(values: np.ndarray) -> str:
    """Return the least and greatest value."""
    return f"{values.min():,.0f} to {values.max():,.0f}"


if __name__ == "__main__":
    main()
