"""The view of a BSDF as people use it: click a direction, see where light goes."""

import re

import numpy as np
import pytest
from lxml import html
from matplotlib.image import imread

from clerestory.bsdf.analytic import clear_air, lambertian
from clerestory.bsdf.bsdf import Bsdf
from clerestory.bsdf.product_data import Product
from clerestory.bsdf.resample import to_trees
from clerestory.hemisphere.klems import klems
from clerestory.report.bsdf_view import write_view

FULL = klems("full")


@pytest.fixture(scope="module")
def page(tmp_path_factory):
    """Air for light from the front, a Lambertian mirror image for the back."""
    air, even = clear_air(FULL), lambertian(0.4, FULL, reflectance=0.3)
    functions = {
        ("visible", "transmission_front"): air.function("transmission_front"),
        ("visible", "reflection_front"): even.function("reflection_front"),
        ("visible", "transmission_back"): even.function("transmission_back"),
        ("visible", "reflection_back"): even.function("reflection_back"),
    }
    file = tmp_path_factory.mktemp("view") / "view.html"
    write_view(Bsdf(functions, Product(name="Air and <chalk>")), file)
    return file


def ask(browse, page, script):
    """What a script run in the finished page returns, as text."""
    text = re.sub(r"<meta http-equiv[^>]*>", "", page.read_text("utf-8"))
    probe = (
        "const wait = setInterval(async () => {"
        " if (!document.documentElement.dataset.scripts) return;"
        f" clearInterval(wait); document.title = await (async () => {{ {script} }})();"
        " }, 50);"
    )
    copy = page.with_name(f"probe-{abs(hash(script))}.html")
    copy.write_text(
        text.replace("</body>", f"<script>{probe}</script></body>"), "utf-8"
    )
    opened = html.document_fromstring(browse(copy, "--dump-dom"))
    return opened.xpath("string(//title)")


CLICK = """
const click = (theta, azimuth) => {
  const canvas = document.getElementById("incident");
  const box = canvas.getBoundingClientRect();
  const disc = view.incident, r = disc.radius / disc.ratio * theta / 90;
  const phi = azimuth * Math.PI / 180;
  const [x, y] = [r * Math.cos(phi), r * Math.sin(phi)];
  canvas.dispatchEvent(new MouseEvent("click", {
    clientX: box.left + box.width / 2 + x, clientY: box.top + box.height / 2 - y }));
};
"""


def test_scripts_run_under_the_content_policy(browse, page):
    opened = html.document_fromstring(browse(page, "--dump-dom"))
    assert opened.get("data-scripts") == "done"
    assert opened.get("data-error") is None
    assert opened.xpath("string(//h1)") == "Air and <chalk>"


def test_a_click_chooses_the_source_and_light_goes_straight_on(browse, page):
    """Source 50° off the normal, to the upper right: air sends it down to the left."""
    answer = ask(
        browse,
        page,
        CLICK
        + """click(50, 45);
        const part = view.part("transmission");
        const values = part.exits.patches.map((_, k) => view.value(part, k));
        const best = values.indexOf(Math.max(...values));
        const words = document.getElementById("incident-words").textContent;
        return [view.patch, best, values[best], words].join("|");""",
    )
    patch, best, value, words = answer.split("|")
    goes_on = -np.array([np.cos(np.pi / 4), np.sin(np.pi / 4), 0]) * np.sin(
        np.radians(50)
    )
    goes_on[2] = np.cos(np.radians(50))
    expected = int(FULL.find(goes_on))
    assert int(patch) == int(best) == expected
    assert float(value) == pytest.approx(
        1 / FULL.projected_solid_angles()[expected], rel=1e-3
    )
    assert "50° off the normal, azimuth 45°" in words


def test_the_other_side_shows_its_own_values(browse, page):
    answer = ask(
        browse,
        page,
        """document.querySelector("[name=side][value=back]").click();
        const part = view.part("transmission");
        const words = document.getElementById("reflection-words").textContent;
        const values = [3, 77, 140].map(k => view.value(part, k));
        return [...values, words.split(" ")[0]].join();""",
    )
    values = [float(word) for word in answer.split(",")]
    assert values[:3] == pytest.approx([0.4 / np.pi] * 3, rel=1e-3)
    assert values[3] == pytest.approx(0.3)


def test_arrow_keys_walk_over_the_patches(browse, page):
    answer = ask(
        browse,
        page,
        CLICK
        + """click(50, 45);
        const before = view.patch, press = key => document.getElementById("incident")
          .dispatchEvent(new KeyboardEvent("keydown", { key, bubbles: true }));
        press("ArrowRight");
        const right = view.patch;
        press("ArrowLeft");
        press("ArrowDown");
        return [before, right, view.incident.rings.patches[view.patch].ring].join();""",
    )
    before, right, ring = map(int, answer.split(","))
    assert right == before + 1
    assert ring == 4


def test_linear_and_logarithmic_scales_differ(browse, page):
    answer = ask(
        browse,
        page,
        """const canvas = document.getElementById("reflection");
        const place = [canvas.width / 3, canvas.height / 3, 1, 1];
        const at = () => canvas.getContext("2d").getImageData(...place).data.join("-");
        const log = at();
        document.querySelector("[name=scale][value=linear]").click();
        return [log, at()].join();""",
    )
    log, linear = answer.split(",")
    assert log != linear


def test_all_canvases_are_painted_and_fit(browse, page, tmp_path):
    file = tmp_path / "view.png"
    browse(page, f"--screenshot={file}", "--window-size=1200,1300")
    pixels = imread(file)[..., :3]
    for rows, columns in (
        (slice(250, 600), slice(60, 410)),
        (slice(250, 600), slice(430, 770)),
        (slice(750, 1200), slice(200, 1000)),
    ):
        part = pixels[rows, columns][::3, ::3].reshape(-1, 3)
        assert len(np.unique(part, axis=0)) > 25


@pytest.mark.parametrize("width", [1024, 500])
def test_nothing_is_wider_than_the_screen(browse, page, width):
    script = "return [document.documentElement.scrollWidth, innerWidth].join();"
    ask(browse, page, script)
    copy = page.with_name(f"probe-{abs(hash(script))}.html")
    dom = browse(copy, "--dump-dom", f"--window-size={width},900")
    content, screen = map(
        int, html.document_fromstring(dom).xpath("string(//title)").split(",")
    )
    assert screen == width
    assert content <= screen


def test_a_tensor_tree_is_shown(browse, tmp_path):
    """A Lambertian tree of 0.4: 0.4/π in every cell, whichever patch is chosen."""
    file = tmp_path / "tree.html"
    write_view(to_trees(lambertian(0.4, klems("quarter")), halvings=3), file)
    answer = ask(
        browse,
        file,
        """const part = view.part("transmission");
        const values = part.exits.patches.map((_, k) => view.value(part, k));
        const error = document.documentElement.dataset.error || "";
        return [Math.min(...values), Math.max(...values), error].join();""",
    )
    low, high, error = answer.split(",")
    assert error == ""
    assert [float(low), float(high)] == pytest.approx([0.4 / np.pi] * 2, rel=1e-3)
