"""States, glare, pictures, film, lamps and the equation's terms on the page."""

import base64
import gzip
import io
import json

import numpy as np
import pytest
import xarray as xr
from lxml import html
from PIL import Image

from clerestory.errors import InputError
from clerestory.image.picture import Picture
from clerestory.report.animation import film_section, film_steps
from clerestory.report.class_map import DayMap
from clerestory.report.colour import value_colours
from clerestory.report.content_from_results import from_results
from clerestory.report.heat_map import day_hour_grid
from clerestory.report.page import report_page
from clerestory.report.view_glare import (
    COLOURS,
    glare_maps,
    shades,
    view_glare,
    worst_steps,
)
from clerestory.report.view_pictures import (
    Moment,
    ViewPictures,
    as_luminance,
    exposures,
    luminance_scale,
    view_pictures,
)
from clerestory.report.window_layers import window_layers
from clerestory.study.results import Results

MOMENTS = [f"01-03T{hour:02d}:30" for hour in range(7, 18)]


@pytest.fixture(scope="module")
def content(room, course, tmp_path_factory):
    folder = tmp_path_factory.mktemp("pictures")
    course.write_pictures(folder, MOMENTS)
    results = course.with_course(
        room.analytic_results(times=room.year(days=10)), pictures=MOMENTS
    )
    return from_results(results, pictures=folder)


@pytest.fixture(scope="module")
def page(content):
    return html.document_fromstring(report_page(content))


@pytest.fixture(scope="module")
def data(page):
    return json.loads(page.xpath("//script[@id='data']")[0].text)


def words(node):
    return " ".join("".join(node.xpath(".//text()")).split())


def unpacked(text, kind):
    return np.frombuffer(gzip.decompress(base64.b64decode(text)), dtype=kind)


def pixels(address):
    raw = base64.b64decode(address.partition(",")[2])
    return np.asarray(Image.open(io.BytesIO(raw)).convert("RGB"), dtype=int)


def test_sections_of_the_course_stand_between_year_and_room(page):
    assert page.xpath("//section/@id")[1:10] == [
        "year",
        "states",
        "film",
        "pictures",
        "glare",
        "lamps",
        "equation",
        "layers",
        "room",
    ]
    links = page.xpath("//nav//a/@href")
    assert links == [f"#{identifier}" for identifier in page.xpath("//section/@id")]


def test_with_views_no_table_is_asked_for(page):
    assert "[[view]]" not in words(page.xpath("//section[@id='year']")[0])


def test_results_without_a_course_have_none_of_its_sections(room):
    results = room.analytic_results(times=room.year(days=2))
    page = html.document_fromstring(report_page(from_results(results)))
    assert not {"states", "film", "pictures", "glare", "lamps", "equation"} & set(
        page.xpath("//section/@id")
    )


def test_states_are_counted_in_the_occupied_hours(page):
    """From 8 to 18 h the blind is open until 10, tilted until 14, then closed."""
    keys = [words(item) for item in page.xpath("//section[@id='states']//li")]
    assert keys == [
        "open: 20.0 %, 20 h",
        "tilted: 40.0 %, 40 h",
        "closed: 40.0 %, 40 h",
    ]
    rule = words(page.xpath("//section[@id='states']")[0])
    assert "cut-off: tilts [°] 0, 45, 90" in rule


def test_the_page_contains_the_state_of_every_step(data, content, course):
    cells = unpacked(data["maps"]["states-0"]["cells"], np.uint8)
    assert data["maps"]["states-0"]["texts"] == list(course.STATES)
    assert np.array_equal(cells, course.state(content.times))


def test_glare_in_words_is_that_of_the_closed_form(page, content, course):
    """DGP grows to 0.4875 at 17:30; the tenth of the hours from there is 5 % and more.

    Of ten occupied hours a day those from 14:30 on lie above 0.40.
    """
    glare = words(page.xpath("//section[@id='glare']")[0])
    assert "A DGP of 0.49 is exceeded in 5 % of the occupied hours: no protec" in glare
    rated = course.dgp(content.times)[content.occupied]
    free = 100 * (rated < 0.40).mean()
    assert f"{free:.1f} % of the hours are free of disturbing glare" in glare
    rows = [words(row) for row in page.xpath("//section[@id='glare']//tbody/tr")]
    counts = np.bincount(
        np.searchsorted((0.35, 0.40, 0.45), rated, side="left"), minlength=4
    )
    hours = "".join(f"{n:.1f} %, {n} h" for n in counts)
    assert rows[0] == f"desk{hours}"


def test_classes_of_glare_are_those_of_the_exact_values(content, course):
    """Rounding for the page moves no step into another class."""
    glare = view_glare(content.data)
    exact = np.searchsorted((0.35, 0.40, 0.45), glare[0].rated(), side="left")
    shown = glare_maps(glare)[0]
    lit = np.isfinite(course.dgp(content.times))
    texts = np.array(shown.texts)[shown.codes[lit]]
    names = ("imperceptible", "perceptible", "disturbing", "intolerable")
    assert all(
        t.endswith(", " + names[k]) for t, k in zip(texts, exact[lit], strict=True)
    )
    assert (shown.codes[~lit] == -1).all()


def test_colours_of_glare_keep_to_their_class():
    colours = shades(np.array([0.1, 0.35, 0.36, 0.41, 0.6]))
    assert np.array_equal(colours[1:], COLOURS)
    assert (colours[0] > colours[1]).all()


def test_the_worst_moments_are_of_different_days(content):
    glare = view_glare(content.data)[0]
    steps = worst_steps(glare, content.times, content.occupied)
    days = content.times[steps].astype("datetime64[D]")
    assert len(set(days.tolist())) == len(steps) == 5
    assert (glare.dgp[steps] == np.nanmax(glare.dgp)).all()


def test_cells_show_the_highest_class_of_their_steps():
    times = np.array(["2021-05-01T10:30", "2023-05-01T10:30"], dtype="datetime64[s]")
    colours = np.zeros((2, 3), dtype=np.uint8)
    shown = DayMap("x", "two years", np.array([1, 0]), ("a", "b"), colours)
    cells = shown.cells(day_hour_grid(times))
    assert sorted(set(cells.tolist())) == [1, 255]


def test_a_class_without_words_is_refused():
    with pytest.raises(InputError, match="class 2"):
        DayMap("x", "y", np.array([2]), ("a", "b"), np.zeros((2, 3), dtype=np.uint8))


def test_every_moment_of_the_day_is_a_frame(data, content):
    shown = data["film"]
    assert shown["clock"] == [moment[6:] for moment in MOMENTS]
    assert [len(view["seen"]) for view in shown["views"]] == [len(MOMENTS)] * 2
    assert shown["views"][0]["notes"][5].startswith("DGP 0.36, perceptible; 1,81")


def test_brighter_moments_look_brighter_but_by_less(data):
    """Twice the luminance is exposed by the root of 2."""
    first, last = (pixels(data["film"]["views"][0]["seen"][k]) for k in (0, -1))
    assert last[30, 40, 1] > first[30, 40, 1] + 5
    assert first[30, 40, 1] > 30
    assert last[30, 40, 1] < 245


def test_false_colour_puts_luminances_on_one_scale(course):
    low, high = (Picture(np.full((4, 6, 3), x, dtype=np.float32)) for x in (0.1, 3.0))
    scale = luminance_scale([low, high])
    assert (scale.smallest, scale.largest) == (1.0, 1000.0)
    assert (
        as_luminance(low, scale)[0, 0].tolist()
        == value_colours(scale, np.array([17.9]))[0].tolist()
    )
    ratio = np.divide(*exposures([high, low]))
    assert ratio == pytest.approx(np.sqrt(30), rel=1e-6)


def test_only_pictures_that_the_study_asked_for_are_shown(room, course, tmp_path):
    course.write_pictures(tmp_path, ["01-02T12:30", "01-05T12:30"])
    results = course.with_course(
        room.analytic_results(times=room.year(days=10)),
        pictures=["01-02T12:30", "01-04T12:30"],
    )
    content = from_results(results, pictures=tmp_path)
    pictures = view_pictures(content)
    files = [m.file.name for view in pictures for m in view.moments]
    assert files == ["desk_01-02T1230.hdr", "door_01-02T1230.hdr"]
    assert not film_section(content).body
    page = html.document_fromstring(report_page(content))
    assert not page.xpath("//section[@id='film']")
    assert len(page.xpath("//section[@id='pictures']//img")) == 4


def test_the_film_is_of_the_day_with_most_pictures(room, tmp_path):
    times = room.year(days=3)
    lit = lambda day, hours: [  # noqa: E731
        Moment(24 * day + hour, tmp_path) for hour in hours
    ]
    views = (
        ViewPictures("a", tuple(lit(0, range(8, 13)))),
        ViewPictures("b", tuple([*lit(1, range(8, 16)), *lit(2, range(8, 16))])),
    )
    brightness = np.where(np.arange(72) >= 48, 1.0, 2.0)
    steps = film_steps(views, times, brightness=brightness)
    assert steps.tolist() == [24 + hour for hour in range(8, 16)]
    assert len(film_steps(views[:1], times, brightness=brightness)) == 0


def test_the_terms_add_up_on_the_page(data, content, course):
    """The sensor that the sun reaches comes first, on a day on which it does."""
    series = data["terms"]["series"][0]
    assert series["name"] == content.sensors.names[3]
    codes = unpacked(series["codes"], np.uint16).reshape(4, -1)
    three, spread, sun, five = np.expm1(codes * data["terms"]["code_step"])
    noon = np.abs(course.hours(content.times) - 12) < 1
    assert np.allclose(spread[noon], 5, rtol=1e-3)
    assert np.allclose(sun[noon], 2000, rtol=1e-3)
    assert np.allclose(five, content.illuminance[3], rtol=1e-3, atol=0.01)
    assert np.allclose(three - spread + sun, five, rtol=1e-3, atol=1.0)


def test_means_of_the_terms_stand_in_a_table(page, content):
    rows = page.xpath("//section[@id='equation']//tbody/tr")
    cells = [words(cell) for cell in rows[0].xpath("td")]
    members = content.sensors.by_grid()["desks"]
    sun = 2000 * 2 / 10 / len(members)
    assert float(cells[2].replace(",", "")) == pytest.approx(sun, rel=5e-3)
    assert float(cells[1]) == pytest.approx(1.0, rel=1e-3)


@pytest.mark.parametrize(
    ("whole", "lines", "headings"),
    [
        (
            "two_phase",
            ["2-phase method, C S", "C_d S_ds", "2-phase method with the exact sun"],
            ["2-phase method [lux]", "= 2-phase method with the exact sun"],
        ),
        (
            "three_phase",
            ["3-phase method, V T D S", "V_d T D_d S_ds", "5-phase method, the sum"],
            ["3-phase method [lux]", "= 5-phase method"],
        ),
        (
            "four_phase",
            ["4-phase method, V T F D S", "V_d T F_d D_d S_ds", "6-phase method"],
            ["4-phase method [lux]", "= 6-phase method"],
        ),
    ],
)
def test_the_terms_are_named_by_the_method(room, course, whole, lines, headings):
    results = course.with_course(room.analytic_results(times=room.year(days=2)))
    if whole != "three_phase":
        results = Results(results.data.rename(three_phase=whole), results.run)
    content = from_results(results)
    section = html.document_fromstring(report_page(content)).get_element_by_id(
        "equation"
    )
    keys = [words(item) for item in section.xpath(".//ul//li")]
    assert all(line in " ".join(keys) for line in lines)
    assert len(keys) == 4
    assert "C_ds S_sun" in keys[2]
    found = [words(cell) for cell in section.xpath(".//th")]
    assert [found[1], found[4]] == headings
    assert ("patches of sky and window" in words(section)) == (whole != "two_phase")


def test_lamps_are_summed_over_the_occupied_hours(page):
    """Half output from 8 to 10 of ten hours on ten days: 10 % or 10 full hours."""
    said = words(page.xpath("//section[@id='lamps']")[0])
    assert "10.0 % of their full output on average, as much as in 10 hours" in said
    assert "they are off in 80.0 % of the hours" in said
    assert "Their energy over all time steps is 12.34 ± 0.06 kWh." in said


def test_layers_keep_what_they_pass(content):
    """A layer that scatters τ/π everywhere passes τ of all light."""
    for layer, tau in zip(window_layers(content.data), (0.6, 0.2), strict=True):
        source = np.array([[0.0, 0.6, -0.8]])
        assert layer.hemispherical(source, function="transmission_front")[
            0
        ] == pytest.approx(tau)


def test_methods_are_compared_with_the_last(room):
    """Twice the reference is 100 % off, and not within 20 % of it."""
    results = room.analytic_results(times=room.year(days=5))
    lux = results.data["illuminance"].values
    both = results.data.assign(
        illuminance_by_method=(
            ("method", "sensor", "time"),
            np.stack([2 * lux, lux]),
        )
    ).assign_coords(method=["3-phase", "5-phase"])
    page = html.document_fromstring(report_page(from_results(Results(both, {}))))
    rows = [
        [words(cell) for cell in row]
        for row in page.xpath("//section[@id='methods']//tbody/tr")
    ]
    assert rows[0][:2] == ["3-phase", "desks"]
    assert rows[0][3] == "100.0 %"
    assert rows[0][5:] == ["0.0 %"] * 3
    assert rows[-1][3:] == ["0.0 %", "0.0 %", "100.0 %", "100.0 %", "100.0 %"]


def test_hours_of_sun_are_bars_on_the_day(room):
    """Sun from 8:00 to 11:00 in one opening, from 10:30 to 12:00 in the other."""
    results = room.analytic_results(times=room.year(days=5))
    minutes = np.arange(1440)
    first = (minutes >= 480) & (minutes < 660)
    second = (minutes >= 630) & (minutes < 720)
    moments = np.datetime64("2023-03-21T00:00:30") + minutes.astype("timedelta64[m]")
    more = xr.Dataset(
        {
            "sun_reaches": (
                ("opening", "moment"),
                np.stack([first, second]),
                {"lowest_sun_deg": 13.0},
            ),
            "hours_of_sun": ("opening", [3.0, 1.5]),
            "room_hours_of_sun": ((), 4.0),
        },
        coords={
            "opening": ["east", "south"],
            "moment": moments.astype("datetime64[ns]"),
        },
    )
    both = Results(xr.merge([results.data, more]).assign_attrs(results.data.attrs))
    page = html.document_fromstring(report_page(from_results(both)))
    section = page.xpath("//section[@id='sunlight']")[0]
    assert "On 21 March the sun reaches the room for 4 h 00 min: level high" in words(
        section
    )
    bars = section.xpath(".//*[local-name()='rect']")
    assert [words(bar) for bar in bars] == ["08:00 to 11:00", "10:30 to 12:00"]
    widths = [float(bar.get("width")) for bar in bars]
    assert widths[0] == pytest.approx(2 * widths[1], abs=0.2)
    assert "from an altitude of 13°" in words(section)
    assert page.xpath("//nav//a[@href='#sunlight']")


def test_pictures_and_drawings_say_what_they_show(page):
    for image in page.xpath("//img"):
        assert image.get("src").startswith("data:image/")
        assert image.get("alt")
    for drawing in page.xpath("//*[local-name()='svg'][not(@aria-hidden)]"):
        assert len(drawing.get("aria-label")) > 20
