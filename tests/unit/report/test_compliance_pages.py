"""Sections on standards: verdicts, maps that are shown once, requirements."""

import pytest
from lxml import html

from clerestory.report.content_from_results import from_results
from clerestory.report.page import report_page
from clerestory.report.variants_page import variants_page
from clerestory.study.results import Results
from clerestory.study.variant_figures import run_figures


@pytest.fixture(scope="module")
def results(room, standard_pages):
    return standard_pages.with_standards(
        room.analytic_results(times=room.year(days=60))
    )


@pytest.fixture(scope="module")
def page(results):
    return html.document_fromstring(report_page(from_results(results)))


def section(page, name):
    (found,) = page.xpath(f"//section[@id='standard-{name}']")
    return found


def test_every_standard_has_a_section_and_a_line_in_the_summary(page):
    names = ["lm-83-12", "leed-v4", "leed-v4-1", "en-17037", "breeam"]
    assert page.xpath("//section[@class='standard']/@id") == [
        f"standard-{name}" for name in names
    ]
    links = page.xpath("//table[@class='standards']//a/@href")
    assert links == [f"#standard-{name}" for name in names]
    assert set(links) <= set(page.xpath("//nav/a/@href"))


def test_maps_that_belong_to_several_standards_are_shown_once(page):
    """sDA and ASE in LM-83 alone, daylight factors in EN 17037 alone."""
    titles = {
        name: section(page, name).xpath(".//figure/figcaption/b/text()")
        for name in ("lm-83-12", "leed-v4", "leed-v4-1", "en-17037", "breeam")
    }
    assert titles == {
        "lm-83-12": ["Daylight autonomy", "Hours of direct sun"],
        "leed-v4": [],
        "leed-v4-1": [],
        "en-17037": [
            *("Daylight provision", "Daylight factor"),
            *("Width of the view", "Distance of the view"),
        ],
        "breeam": [],
    }


@pytest.mark.parametrize(
    ("name", "other"),
    [("leed-v4", "lm-83-12"), ("leed-v4-1", "lm-83-12"), ("breeam", "en-17037")],
)
def test_other_sections_refer_to_the_maps(page, name, other):
    found = section(page, name).xpath(".//p/a/@href")
    assert found == [f"#standard-{other}"]
    assert page.xpath(f"//section[@id='standard-{other}']//figure")


def test_requirements_are_listed_with_what_to_change(page):
    rows = section(page, "lm-83-12").xpath(".//table[@class='requirements']/tbody/tr")
    cells = {row.xpath("string(th)"): row.xpath("td/text()") for row in rows}
    assert cells["Grid spacing"][0] == "not fulfilled"
    assert "0.80 m" in cells["Grid spacing"][1]
    assert "at most 0.6 m" in cells["Grid spacing"][3]
    statuses = [row.xpath("string(td[1])") for row in rows]
    order = ["not fulfilled", "not known", "fulfilled"]
    assert statuses == sorted(statuses, key=order.index)


def test_maps_are_headed_by_space_and_grid(results, page):
    assert section(page, "lm-83-12").xpath("h3/text()")[2] == "desks"
    named = results.data.copy()
    named["space"] = named["space"].copy(data=["office"] * named.sizes["sensor"])
    other = html.document_fromstring(
        report_page(from_results(Results(named, results.run)))
    )
    assert section(other, "lm-83-12").xpath("h3/text()")[2] == "office · desks"


def test_variants_are_compared_by_the_verdicts_on_all_spaces(results, page):
    """The first run without standards has empty cells."""
    plain = results.data.drop_vars(
        [name for name in results.data.variables if str(name).startswith("verdict_")]
    )
    runs = [
        run_figures(Results(plain, results.run), name="plain"),
        run_figures(results, name="assessed"),
    ]
    text = variants_page(runs, title="Two runs")
    table = html.document_fromstring(text).xpath("//table[@class='verdict-table']")[0]
    heads = [" ".join(head.itertext()) for head in table.xpath("./thead/tr/th")][2:]
    rows = table.xpath("./tbody/tr")
    first, second = ([cell.text for cell in row.xpath("td")][1:] for row in rows)
    assert first == [None] * len(heads)
    own = section(page, "lm-83-12").xpath("ul[@class='verdicts']/li/b/text()")
    assert heads[0] == "LM-83-12 Spatial daylight autonomy"
    assert second[: len(own)] == own
    assert len(second) == len(heads) > len(own)
