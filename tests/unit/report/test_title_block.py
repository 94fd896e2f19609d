"""Title block, notes in Markdown, PDF files, and words of standards."""

import io
import os
import shutil

import numpy as np
import pytest
from lxml import html
from PIL import Image

from clerestory.bsdf.analytic import lambertian
from clerestory.errors import InputError, OutputError
from clerestory.hemisphere.klems import klems
from clerestory.metrics.en17037 import daylight_provision
from clerestory.report import pdf
from clerestory.report.bsdf_plot import share_figure
from clerestory.report.compliance_words import provision_words
from clerestory.report.content_from_results import from_results
from clerestory.report.figure_axes import log_norm
from clerestory.report.markdown import markdown
from clerestory.report.page import report_page, write_report
from clerestory.report.variants_page import variants_page
from clerestory.study.result_checks import check_run
from clerestory.study.results import Results
from clerestory.study.title_block import TitleBlock, title_block_of
from clerestory.study.variant_figures import run_figures

NOTES = "# Findings\n\n*Glare* is rare.\n\n| a | b |\n|---|---|\n| 1 | 2 |\n"


def logo_file(folder, *, size=(900, 300), kind="PNG"):
    image = Image.new("RGBA", size, (0, 0, 0, 0))
    image.paste((200, 30, 30, 255), (0, 0, size[0] // 2, size[1]))
    path = folder / f"logo.{kind.lower()}"
    image.convert("RGB" if kind == "JPEG" else "RGBA").save(path, format=kind)
    return path


@pytest.fixture
def block(tmp_path):
    (tmp_path / "notes.md").write_text(NOTES, encoding="utf-8")
    return TitleBlock("Library", "City of Oslo", "A. Bauer").with_changes(
        logo=logo_file(tmp_path), notes=tmp_path / "notes.md"
    )


@pytest.fixture(scope="module")
def results(room):
    return room.analytic_results(times=room.year(days=3))


def page_of(results, block):
    run = {**results.run, "report": block.facts()}
    return html.document_fromstring(
        report_page(from_results(Results(results.data, run)))
    )


def test_the_title_block_of_a_run_is_shown_and_read_back(results, block, tmp_path):
    check_run({"report": block.facts()}, tmp_path)
    assert title_block_of({"report": block.facts()}) == block
    page = page_of(results, block)
    pairs = zip(
        page.xpath("//dl[@class='title-block']//dt/text()"),
        page.xpath("//dl[@class='title-block']//dd/text()"),
        strict=True,
    )
    assert dict(pairs) == {
        **{"Project": "Library", "Client": "City of Oslo", "Author": "A. Bauer"}
    }
    (logo,) = page.xpath("//img[@class='logo']")
    assert logo.get("alt") == "Logo of A. Bauer"
    assert logo.get("src").startswith("data:image/png;base64,")


def test_notes_stand_before_the_results_and_in_the_contents(results, block):
    page = page_of(results, block)
    assert page.xpath("string(//section[@id='notes']/h3)") == "Findings"
    assert page.xpath("//section[@id='notes']//em/text()") == ["Glare"]
    assert page.xpath("//section[@id='notes']//td/text()") == ["1", "2"]
    assert page.xpath("//nav/a/@href")[0] == "#notes"
    assert page.xpath("//section/@id")[0] == "notes"


def test_a_report_without_title_block_has_no_empty_one(results):
    page = html.document_fromstring(report_page(from_results(results)))
    assert not page.xpath("//*[@class='title-block' or @class='logo' or @id='notes']")


def test_logos_are_reduced_and_transparent_pixels_become_white(block, tmp_path):
    image = Image.open(io.BytesIO(block.logo))
    assert image.size == (480, 160)
    pixels = np.asarray(image)
    assert pixels[80, 60].tolist() == [200, 30, 30]
    assert pixels[80, 420].tolist() == [255, 255, 255]
    jpeg = logo_file(tmp_path, size=(64, 32), kind="JPEG")
    assert Image.open(io.BytesIO(TitleBlock().with_changes(logo=jpeg).logo)).size == (
        *(64, 32),
    )


@pytest.mark.parametrize(
    "content", [b"", b"no image", b"\x89PNG\r\n\x1a\n" + bytes(40)]
)
def test_a_damaged_logo_is_an_error_with_its_name(content, tmp_path):
    file = tmp_path / "logo.png"
    file.write_bytes(content)
    with pytest.raises(InputError, match=r"logo\.png: not a PNG or JPEG image"):
        TitleBlock().with_changes(logo=file)


def test_an_image_of_another_format_is_refused(tmp_path):
    file = tmp_path / "logo.png"
    Image.new("RGB", (8, 8)).save(file, format="BMP")
    with pytest.raises(InputError, match="format BMP; PNG or JPEG expected"):
        TitleBlock().with_changes(logo=file)


@pytest.mark.parametrize(
    "text",
    [
        "<script>alert(1)</script>",
        "<img src=x onerror=alert(1)>",
        "[x](javascript:alert(1))",
        "[x](data:text/html,<script>alert(1)</script>)",
        "![x](http://evil.example/x.png)",
        "<a href='javascript:alert(1)'>x</a>",
        "[x]: javascript:alert(1)\n\n[x]",
        "<javascript:alert(1)>",
        "`<b>`\n\n    <style>*{display:none}</style>",
        "<!-- --><iframe src=//evil.example></iframe>",
    ],
)
def test_notes_cannot_bring_markup_or_scripts_into_the_page(text):
    node = html.fragment_fromstring(markdown(text), create_parent="div")
    tags = {one.tag for one in node.iterdescendants()}
    assert tags <= {"p", "a", "code", "pre", "em"}
    for link in node.xpath(".//a"):
        assert set(link.attrib) <= {"href", "rel"}
        assert link.get("href").startswith(("http", "mailto:", "#"))


def test_images_in_notes_become_their_text():
    made = markdown("![plan <b> of *desks*](http://evil.example/x.png)")
    assert made == "<p>plan &lt;b&gt; of *desks*</p>\n"


def test_the_logo_in_run_json_must_be_base64(tmp_path):
    with pytest.raises(InputError, match=r"report\.logo"):
        check_run({"report": {"logo": '"><script>'}}, tmp_path)


def test_the_page_of_variants_has_the_title_block_too(results, block):
    runs = [run_figures(results, name=name) for name in ("a", "b")]
    page = html.document_fromstring(variants_page(runs, title="T", title_block=block))
    assert page.xpath("//dl[@class='title-block']//dd/text()")[0] == "Library"
    assert page.xpath("string(//div[@class='notes']/h3)") == "Findings"


def test_without_a_browser_the_pdf_is_one_clear_line(monkeypatch, tmp_path):
    page = tmp_path / "report.html"
    page.write_text("<p>x", encoding="utf-8")
    monkeypatch.setattr(pdf.shutil, "which", lambda name: None)
    monkeypatch.setattr(pdf, "_PLACES", ())
    with pytest.raises(OutputError, match="needs Chromium, Chrome or Edge") as caught:
        pdf.write_pdf(page, tmp_path / "report.pdf")
    assert "\n" not in str(caught.value)
    assert [path.name for path in tmp_path.iterdir()] == ["report.html"]


def test_a_browser_that_writes_no_pdf_is_an_error_with_its_message(
    monkeypatch, tmp_path
):
    browser = tmp_path / "chromium"
    browser.write_text("#!/bin/sh\necho broken >&2\n", encoding="utf-8")
    browser.chmod(0o755)
    monkeypatch.setenv("PATH", f"{tmp_path}{os.pathsep}/bin")
    page = tmp_path / "report.html"
    page.write_text("<p>x", encoding="utf-8")
    with pytest.raises(OutputError, match="wrote no PDF: broken"):
        pdf.write_pdf(page, tmp_path / "report.pdf")
    assert not (tmp_path / "report.pdf").exists()


@pytest.mark.slow
def test_a_report_is_printed_to_pdf(results, block, tmp_path):
    if not any(map(shutil.which, pdf._PROGRAMS)):
        pytest.skip("no Chromium here: install Debian's package `chromium`")
    page = tmp_path / "report.html"
    write_report(results, page, title_block=block)
    pdf.write_pdf(page, tmp_path / "report.pdf")
    assert (tmp_path / "report.pdf").read_bytes().startswith(b"%PDF")


def test_daylight_provision_is_stated_with_the_areas_that_are_missing(room):
    """Half of the sensors have 400 lux, the others 120 lux, all the time."""
    data = room.analytic_results(times=room.year(days=1)).data
    lux = data["illuminance"][:4].copy(data=np.full((4, data.sizes["time"]), 120.0))
    lux[:1] = 400.0
    hours = np.ones(data.sizes["time"], dtype=bool)
    words = provision_words(daylight_provision(lux, hours))
    assert words == (
        "no level; level minimum needs 300 lux on 50 % of the area (found: 25 %) and"
        " 100 lux on 95 % of the area (found: 100 %)"
    )
    bright = provision_words(daylight_provision(0 * lux + 900, hours))
    assert bright.startswith("level high; it needs 750 lux on 50 % of the area")


def test_opaque_layers_are_drawn_dark():
    """Noise of 1e-7/sr lies in the darkest tenth of the scale, also if it is all."""
    norm = log_norm(np.full(9, 1e-7), decades=5, quantile=0.01, least_top=1e-3)
    assert float(norm(np.float64(1e-7))) < 0.1
    assert norm.vmax == 1e-3
    bright = log_norm(np.array([0.01, 100.0]), decades=5, quantile=0.01, least_top=1e-3)
    assert bright.vmax == 100.0


def test_the_legend_of_transmittances_is_outside_the_curves():
    layers = [lambertian(0.3, klems("half"))] * 6
    figure = share_figure(layers, names=list("abcdef"))
    assert all(axes.get_legend() is None for axes in figure.axes)
    figure.draw_without_rendering()
    low = figure.legends[0].get_window_extent().y1
    assert all(low <= axes.get_window_extent().y0 for axes in figure.axes)
