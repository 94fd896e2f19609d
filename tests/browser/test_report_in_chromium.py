"""The report as people see it: scripts run, pictures are painted, nothing cut off."""

import importlib.util
import re
from pathlib import Path

import numpy as np
import pytest
from lxml import html
from matplotlib.image import imread

from chromium_probe import ask, probed
from clerestory.report.page import write_report


@pytest.fixture(scope="module")
def opened(browse, report):
    return html.document_fromstring(browse(report, "--dump-dom"))


def screenshot(browse, page, file, *, width, height):
    browse(page, f"--screenshot={file}", f"--window-size={width},{height}")
    return imread(file)[..., :3]


def test_scripts_run_to_their_end_without_errors(opened):
    assert opened.get("data-scripts") == "done"
    assert opened.get("data-error") is None


def test_the_3d_view_names_the_window_and_north(opened):
    marks = opened.xpath("//span[contains(@class, 'mark')]/text()")
    assert "front of south" in marks
    assert "N" in marks


def test_the_3d_view_is_painted_in_its_colours(browse, report):
    """Green where the front of the window is seen, and the dots of the sensors."""
    answer = ask(
        browse,
        report,
        """const c = document.querySelector("#stage canvas");
        const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
        let green = 0, seen = new Set();
        for (let k = 0; k < d.length; k += 4) {
          if (d[k + 1] > d[k] + 20 && d[k + 1] > d[k + 2] + 8) green++;
          seen.add(d[k] << 16 | d[k + 1] << 8 | d[k + 2]);
        }
        return `${green / (c.width * c.height)} ${seen.size}`;""",
    )
    green, colours = map(float, answer.split())
    assert green > 0.01
    assert colours > 200


def test_from_outside_the_back_of_the_window_is_orange(browse, report):
    answer = ask(
        browse,
        report,
        """document.querySelector("[data-look=outside]").click();
        const c = document.querySelector("#stage canvas");
        const d = c.getContext("2d").getImageData(0, 0, c.width, c.height).data;
        let orange = 0;
        for (let k = 0; k < d.length; k += 4) if (d[k] > d[k + 2] + 30) orange++;
        return orange / (c.width * c.height);""",
    )
    assert float(answer) > 0.01


def test_the_chosen_series_is_painted_with_the_right_values(browse, room, report):
    """The page decodes the hours of a sensor to the illuminance of the closed form."""
    times = room.year()
    lux = np.pi * room.sky_factor(room.desk_points())[9] * room.sky_luminance(times)
    answer = ask(
        browse,
        report,
        """const data = JSON.parse(document.getElementById("data").textContent);
        const series = data.year.series.find(s => s.name === "desks.10");
        const codes = new Uint16Array(await unpack(series.codes));
        const step = data.year.code_step;
        return [12, 4332, 8000].map(t => Math.expm1(codes[t] * step)).join();""",
    )
    assert np.allclose(
        [float(x) for x in answer.split(",")], lux[[12, 4332, 8000]], rtol=1e-3
    )


def test_choosing_a_sensor_in_a_plan_shows_its_year(browse, report):
    answer = ask(
        browse,
        report,
        """const data = JSON.parse(document.getElementById("data").textContent);
        const svg = document.querySelector("svg.plan");
        const grid = data.grids[svg.dataset.grid];
        const picture = document.querySelector("#heat-map image");
        const before = picture.getAttribute("href");
        const place = new DOMPoint(grid.x[20], grid.y[20]);
        const at = place.matrixTransform(svg.getScreenCTM());
        svg.dispatchEvent(new MouseEvent("click", {clientX: at.x, clientY: at.y}));
        await new Promise(done => setTimeout(done, 500));
        const shown = document.getElementById("series").selectedOptions[0].text;
        const ringed = svg.querySelector(".chosen").getAttribute("cx") == grid.x[20];
        return [shown, before !== picture.getAttribute("href"), ringed].join();""",
    )
    assert answer == "desks.21,true,true"


@pytest.mark.parametrize("width", [1024, 500])
def test_nothing_is_wider_than_the_screen(browse, report, width):
    page = probed(
        report,
        "return [document.documentElement.scrollWidth, innerWidth].join();",
    )
    dom = browse(page, "--dump-dom", f"--window-size={width},900")
    content, screen = map(
        int, html.document_fromstring(dom).xpath("string(//title)").split(",")
    )
    assert screen == width
    assert content <= screen


def test_screenshots_are_not_blank(browse, report, tmp_path):
    pixels = screenshot(browse, report, tmp_path / "page.png", width=1280, height=4800)
    assert pixels.shape == (4800, 1280, 3)
    for top in range(0, 4000, 800):
        part = pixels[top : top + 800]
        assert len(np.unique(part[::4, ::4].reshape(-1, 3), axis=0)) > 30
    # The page is white with dark text
    assert np.median(pixels) == 1
    assert pixels.min() < 0.2


def test_a_window_turned_round_is_flagged_in_the_view(browse, room, tmp_path):
    page = tmp_path / "report.html"
    write_report(room.analytic_results(times=room.year(days=5), inward=False), page)
    dom = html.document_fromstring(browse(page, "--dump-dom"))
    assert "front of south: check" in dom.xpath("//span/text()")


def test_a_hostile_title_runs_no_script(browse, room, tmp_path):
    title = (
        '</script><script>document.title="broken"</script><img src=x onerror=alert(1)>'
    )
    page = tmp_path / "report.html"
    write_report(room.analytic_results(times=room.year(days=2), title=title), page)
    dom = html.document_fromstring(browse(page, "--dump-dom"))
    assert dom.get("data-scripts") == "done"
    assert dom.xpath("string(//title)").startswith("</script>")
    assert not dom.xpath("//img")


def test_a_single_dark_sensor_opens_without_errors(browse, room, tmp_path):
    page = tmp_path / "report.html"
    night = np.array(["2023-01-01T00:30"], dtype="datetime64[s]")
    results = room.analytic_results(
        times=night,
        points=np.array([[3.0, 2.0, 0.76]]),
        with_eyes=False,
        luminance=np.zeros(1),
    )
    write_report(results, page)
    dom = html.document_fromstring(browse(page, "--dump-dom"))
    assert dom.get("data-scripts") == "done"
    assert dom.get("data-error") is None


def test_the_report_prints(browse, report, tmp_path):
    file = tmp_path / "report.pdf"
    browse(report, "--no-pdf-header-footer", f"--print-to-pdf={file}")
    content = file.read_bytes()
    assert content.startswith(b"%PDF")
    assert 2 <= len(re.findall(rb"/Type\s*/Page\b", content)) <= 12


@pytest.fixture(scope="module")
def grid_report(room, tmp_path_factory):
    """Report of a year with a view grid of 6 positions and 8 directions."""
    file = Path(__file__).parents[1] / "unit" / "report" / "view_grids.py"
    spec = importlib.util.spec_from_file_location("view_grids", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    results = module.with_view_grids(room.analytic_results(), module.grid(2, 3))
    page = tmp_path_factory.mktemp("grids") / "report.html"
    write_report(results, page)
    return page


def test_a_sector_of_a_rosette_shows_the_year_of_its_view(browse, grid_report):
    """The sector towards the window, at the position farthest from it."""
    answer = ask(
        browse,
        grid_report,
        "const data = JSON.parse(document.getElementById('data').textContent);"
        "const level = data.rosettes.grids[0].levels[0];"
        "const plan = document.querySelector('svg.rosettes'), k = 4;"
        "const at = new DOMPoint(level.x[k], level.y[k] + level.radius / 2)"
        ".matrixTransform(plan.getScreenCTM());"
        "plan.dispatchEvent(new MouseEvent('click',"
        " {clientX: at.x, clientY: at.y, bubbles: true}));"
        "return document.querySelector('.chosen-view').textContent;",
    )
    assert answer.startswith("Position 5 (x 0.60, y 8.30, z 1.20 m), south, 180°: DGP")
    assert "high protection" in answer


def test_views_of_a_grid_can_be_chosen_by_keyboard(browse, grid_report):
    """The lists of positions and directions change text and image of the year."""
    answer = ask(
        browse,
        grid_report,
        "const year = document.querySelector('#view-grid-0-year image');"
        "const before = year.getAttribute('href');"
        "const list = document.getElementById('view-grid-0-direction');"
        "list.value = 0; list.dispatchEvent(new Event('change'));"
        "return [before !== year.getAttribute('href'),"
        " document.querySelector('.chosen-view').textContent].join('|');",
    )
    assert answer.startswith("true|Position")
    assert "north, 0°" in answer
