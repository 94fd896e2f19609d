"""States, glare, film and the equation's terms as people use them."""

import re

import pytest
from lxml import html

from chromium_probe import ask


def test_scripts_run_to_their_end_under_the_policy(browse, full_report):
    opened = html.document_fromstring(browse(full_report, "--dump-dom"))
    assert opened.get("data-scripts") == "done"
    assert opened.get("data-error") is None


def test_the_slider_shows_its_frame_and_its_words(browse, full_report):
    answer = ask(
        browse,
        full_report,
        """const slider = document.getElementById("film-slider");
        const image = () => document.querySelector("#film .screens img").src;
        const middle = image();
        slider.value = 0;
        slider.dispatchEvent(new Event("input"));
        const said = document.querySelector("#film .said").textContent;
        return [document.getElementById("film-clock").textContent, middle !== image(),
          said.split(",")[0]].join("|");""",
    )
    assert answer == "07:30|true|DGP 0.24"


def test_play_goes_on_and_pause_stays(browse, full_report):
    answer = ask(
        browse,
        full_report,
        """const slider = document.getElementById("film-slider");
        const button = document.getElementById("film-play");
        const before = +slider.value;
        button.click();
        const playing = button.textContent;
        await new Promise(done => setTimeout(done, 1800));
        button.click();
        const after = +slider.value;
        await new Promise(done => setTimeout(done, 1200));
        return [playing, after !== before, +slider.value === after,
          button.textContent].join();""",
    )
    assert answer == "Pause,true,true,Play"


def test_luminances_come_with_their_scale(browse, full_report):
    answer = ask(
        browse,
        full_report,
        """const look = document.getElementById("film-look");
        const scales = document.getElementById("film-scales");
        const image = () => document.querySelector("#film .screens img").src;
        const [before, hidden] = [image(), scales.hidden];
        look.value = "luminance";
        look.dispatchEvent(new Event("change"));
        return [hidden, scales.hidden, before !== image()].join();""",
    )
    assert answer == "true,false,true"


POINT = """const svg = document.getElementById(ID), box = svg.dataset;
    const x = +box.left + +box.width * (4.5 / 30);
    const y = +box.top + +box.height * (1 - HOUR / 24);
    const at = new DOMPoint(x, y).matrixTransform(svg.getScreenCTM());
    svg.dispatchEvent(new PointerEvent("pointermove",
      {clientX: at.x, clientY: at.y, bubbles: true}));
    return document.getElementById("tip").textContent;"""


@pytest.mark.parametrize(
    ("identifier", "hour", "said"),
    [
        ("states-0", 9.5, "5 Jan, 09:00–10:00\nopen"),
        ("states-0", 15.5, "closed"),
        ("glare-0", 16.5, "DGP 0.46, intolerable"),
        ("glare-0", 2.5, "no data"),
        ("lamps-0", 8.5, "output 50 %"),
    ],
)
def test_maps_say_what_a_cell_stands_for(browse, full_report, identifier, hour, said):
    script = POINT.replace("ID", f'"{identifier}"').replace("HOUR", str(hour))
    assert said.split("\n")[-1] in ask(browse, full_report, script)


def test_the_next_day_draws_other_lines(browse, full_report):
    answer = ask(
        browse,
        full_report,
        """const lines = () => document.getElementById("term-lines").innerHTML;
        const day = document.getElementById("term-day");
        const before = [lines(), day.textContent];
        document.querySelector("#equation [data-step='1']").click();
        const after = [lines(), day.textContent];
        return [before[0] !== after[0], before[1] !== after[1]].join();""",
    )
    assert answer == "true,true"


def test_the_script_draws_what_the_page_was_written_with(browse, full_report):
    """The chart of the start is the same with and without the script."""
    page = html.document_fromstring(full_report.read_text(encoding="utf-8"))
    written = page.xpath("//*[@id='term-lines']/*/@d")
    drawn = ask(
        browse,
        full_report,
        """return [...document.querySelectorAll("#term-lines path")]
        .map(p => p.getAttribute("d")).join("|");""",
    ).split("|")
    for ours, theirs in zip(written, drawn, strict=True):
        numbers = [[float(x) for x in re.findall(r"[\d.]+", d)] for d in (ours, theirs)]
        assert numbers[1] == pytest.approx(numbers[0], abs=0.15)


@pytest.mark.parametrize("width", [1024, 500])
def test_nothing_is_wider_than_the_screen(browse, full_report, width):
    script = "return [document.documentElement.scrollWidth, innerWidth].join();"
    text = re.sub(r"<meta http-equiv[^>]*>", "", full_report.read_text("utf-8"))
    copy = full_report.with_name(f"wide-{width}.html")
    probe = f"""const wait = setInterval(() => {{
        if (!document.documentElement.dataset.scripts) return;
        clearInterval(wait); document.title = (() => {{ {script} }})(); }}, 50);"""
    copy.write_text(text.replace("</body>", f"<script>{probe}</script></body>"))
    dom = browse(copy, "--dump-dom", f"--window-size={width},900")
    title = html.document_fromstring(dom).xpath("string(//title)")
    content, screen = map(int, title.split(","))
    assert screen == width
    assert content <= screen


def test_the_full_report_prints(browse, full_report, tmp_path):
    file = tmp_path / "report.pdf"
    browse(full_report, "--no-pdf-header-footer", f"--print-to-pdf={file}")
    pages = len(re.findall(rb"/Type\s*/Page\b", file.read_bytes()))
    assert 5 <= pages <= 20
