"""The page: complete, self-contained, safe."""

import base64
import hashlib
import json
import re

import numpy as np
import pytest
from lxml import html

from clerestory.errors import InputError, OutputError
from clerestory.report.content_from_results import from_results
from clerestory.report.page import report_page, write_report
from clerestory.study.results import Results

HOSTILE = (
    '</script><script>alert(1)</script> & "quoted" <b>bold</b> é \u2028 {x} $title'
)


@pytest.fixture(scope="module")
def text(room):
    return report_page(from_results(room.analytic_results(times=room.year(days=30))))


@pytest.fixture(scope="module")
def page(text):
    return html.document_fromstring(text)


def words(node):
    seen = node.xpath(".//text()[not(ancestor::script or ancestor::style)]")
    return " ".join("".join(seen).split())


def test_the_page_asks_nothing_of_the_network(page):
    """Addresses are data or places in the page; even the XML namespaces are absent."""
    for node in page.iter():
        for name, value in node.attrib.items():
            if name in ("src", "href", "srcset", "action", "data", "poster"):
                assert value.startswith(("data:", "#")), (
                    f"{node.tag} {name}={value[:60]}"
                )
    assert not page.xpath("//link | //iframe | //object | //embed | //img | //base")
    style = page.xpath("string(//style)")
    assert "url(" not in style
    assert "@import" not in style


def test_no_script_names_another_host(text):
    assert not re.search(r"https?://", text)


def test_the_policy_allows_the_pages_own_script_alone(page):
    policy = page.xpath("string(//meta[@http-equiv]/@content)")
    script = page.xpath("//script[not(@type)]")
    assert len(script) == 1
    digest = base64.b64encode(hashlib.sha256(script[0].text.encode()).digest()).decode()
    assert f"'sha256-{digest}'" in policy
    assert "default-src 'none'" in policy


def test_a_hostile_title_stays_text(room):
    results = room.analytic_results(title=HOSTILE, times=room.year(days=2))
    results.run["warnings"].append(HOSTILE)
    renamed = results.data.assign_coords(
        grid=("sensor", [HOSTILE] * results.data.sizes["sensor"]),
        window=[HOSTILE],
    )
    page = html.document_fromstring(
        report_page(from_results(Results(renamed, results.run)))
    )
    plain = HOSTILE.replace("\u2028", " ")
    assert words(page.xpath("//h1")[0]) == " ".join(plain.split())
    assert len(page.xpath("//script")) == 2
    assert not page.xpath("//b[text()='bold']")
    data = json.loads(page.xpath("//script[@id='data']")[0].text)
    assert data["view"]["windows"][0]["name"] == HOSTILE
    assert HOSTILE in data["year"]["series"][0]["name"]


def test_every_picture_says_what_it_shows(page):
    pictures = page.xpath("//*[local-name()='svg' or local-name()='canvas']")
    shown = [p for p in pictures if p.get("aria-hidden") != "true"]
    assert len(shown) >= 6 + 3 + 1 + 1 + 1
    for picture in shown:
        assert picture.get("role") == "img"
        assert len(picture.get("aria-label")) > 20


def test_identifiers_are_unique_but_for_gradients_of_equal_scales(page):
    found = page.xpath("//*[@id and local-name()!='lineargradient']/@id")
    found = [i for i in found if not i.startswith("scale-")]
    assert len(found) == len(set(found))


def test_used_shapes_exist(page):
    defined = set(page.xpath("//@id"))
    used = page.xpath("//*[local-name()='use']/@href")
    assert used
    assert {address.removeprefix("#") for address in used} <= defined


def test_the_headline_gives_the_mean_of_the_first_grid(room, page):
    """The closed form gives the illuminance; the mean over 08:00–18:00 follows."""
    times = room.year(days=30)
    hour = (times - times.astype("datetime64[D]")) / np.timedelta64(1, "h")
    lux = np.pi * np.outer(
        room.sky_factor(room.desk_points()), room.sky_luminance(times)
    )
    mean = lux[:, (hour >= 8) & (hour < 18)].mean()
    figures = page.xpath("//dl[@class='key-figures']//dd[1]")
    assert words(figures[0]).startswith(f"{mean:,.0f} ±")


def test_a_selection_of_many_sensors_is_stated(room):
    """A note, and no warning, tells how many sensors the page shows."""
    results = room.analytic_results(times=room.year(days=2))
    count = results.data.sizes["sensor"]
    content = from_results(results, most_sensors=20)
    page = html.document_fromstring(report_page(content))
    shown = len(content.sensors.names)
    assert shown <= 20 < count
    notes = [words(note) for note in page.xpath("//header/p[@class='note']")]
    assert notes[0].startswith(f"This page shows {shown} of {count} sensors")
    assert not content.warnings


def test_sections_stand_in_their_order(page):
    assert [words(h) for h in page.xpath("//h2")] == [
        "Distribution of daylight",
        "Illuminance through the year",
        "The room and the orientation of its windows",
        "Uncertainty of the results",
        "How it was computed",
        "Glossary",
    ]


def test_without_views_the_page_says_how_to_get_glare(page):
    assert "add a table [[view]]" in words(page.xpath("//section[@id='year']")[0])


def test_parameters_times_and_versions_are_shown(page):
    making = words(page.xpath("//section[@id='making']")[0])
    for expected in (
        "open.xml",
        "Relative error",
        "3.9.1",
        "view matrix",
        "4.2 s",
        "LLVM",
    ):
        assert expected in making


def test_warnings_of_the_run_come_first(room):
    results = room.analytic_results(times=room.year(days=2))
    results.run["warnings"].append("BSDF loses 12 % of the light")
    page = html.document_fromstring(report_page(from_results(results)))
    assert "BSDF loses 12 %" in words(page.xpath("//header")[0])


def test_a_window_turned_round_is_pointed_out(room):
    results = room.analytic_results(times=room.year(days=2), inward=False)
    page = html.document_fromstring(report_page(from_results(results)))
    assert "faces away from" in words(page.xpath("//header")[0])
    assert page.xpath("//*[@class='normal wrong']")


def test_a_right_window_raises_no_doubt(page):
    assert not page.xpath(
        "//*[contains(@class, 'warnings') or contains(@class, 'doubt')]"
    )


def test_a_single_sensor_at_a_single_step_has_a_page(room):
    noon = np.array(["2023-06-21T12:00"], dtype="datetime64[s]")
    results = room.analytic_results(
        times=noon, points=np.array([[3.0, 2.0, 0.76]]), with_eyes=False
    )
    page = html.document_fromstring(report_page(from_results(results)))
    assert "the sensor “desks.1” receives" in words(page.xpath("//header")[0])
    assert not re.search(r"\bnan\b", words(page), re.IGNORECASE)


def test_a_year_of_darkness_has_a_page(room):
    times = room.year(days=3)
    results = room.analytic_results(times=times, luminance=np.zeros(len(times)))
    page = html.document_fromstring(report_page(from_results(results)))
    assert "No sensor receives more than 10 lux" in words(page)
    assert not re.search(r"\bnan\b", words(page), re.IGNORECASE)


def test_a_scene_without_windows_has_a_page(room):
    results = room.analytic_results(times=room.year(days=2))
    bare = results.data.drop_vars(
        [
            name
            for name in results.data.variables
            if name.startswith(("window", "triangle"))
        ]
    )
    page = html.document_fromstring(report_page(from_results(Results(bare, {}))))
    assert page.xpath("//canvas")


def test_values_that_are_not_numbers_are_refused(room):
    results = room.analytic_results(times=room.year(days=2))
    results.data["illuminance"][0, 5] = np.nan
    with pytest.raises(InputError, match="NaN or infinite"):
        from_results(results)


def test_a_page_without_a_folder_is_an_error(room, tmp_path):
    results = room.analytic_results(times=room.year(days=1))
    with pytest.raises(OutputError):
        write_report(results, tmp_path / "missing" / "report.html")


def test_equal_results_make_equal_pages(room, text):
    again = report_page(from_results(room.analytic_results(times=room.year(days=30))))
    assert again == text


def test_hundreds_of_sensors_over_a_year_stay_below_eight_megabytes(room):
    points = np.random.default_rng(2).uniform([0, 0, 0.8], [6, 9, 0.8], size=(300, 3))
    results = room.analytic_results(points=points)
    page = report_page(from_results(results))
    assert "of the 304 sensors, evenly chosen" in page
    assert len(page) < 8e6
