"""The interactive page as a file: self-contained, within its size, gaps named."""

import base64
import importlib.util
import json
import re
from pathlib import Path

import numpy as np
import pytest
from lxml import html

from clerestory.report import explore_page
from clerestory.report.explore_page import offline_page
from clerestory.report.hourly_codes import STEP, decoded_illuminance, decompressed


def module(name):
    file = Path(__file__).with_name(f"{name}.py")
    spec = importlib.util.spec_from_file_location(name, file)
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


@pytest.fixture(scope="module")
def results(room):
    year = room.analytic_results(times=room.year(days=20))
    return module("shade_states").with_states(module("course").with_course(year))


@pytest.fixture(scope="module")
def page(results):
    return html.document_fromstring(offline_page(results))


def part(page, name):
    return page.xpath(f"string(//script[@id='part-{name}'])")


def test_the_page_asks_nothing_of_the_network(page):
    for node in page.iter():
        for name, value in node.attrib.items():
            if name in {"src", "href", "action", "srcset", "data"}:
                assert value.startswith(("data:", "#"))
    policy = page.xpath("//meta[@http-equiv]/@content")[0]
    assert "default-src 'none'" in policy
    assert "'self'" not in policy


@pytest.mark.parametrize("name", ["operated", "state-0-0", "state-0-2"])
def test_hours_are_those_of_the_results(page, results, name):
    data, facts = results.data, json.loads(page.xpath("string(//script[@id='data'])"))
    count = len(facts["sensors"])
    found = decompressed(base64.b64decode(part(page, name)), places=count)
    if name == "operated":
        lux = data["illuminance"].values
    else:
        lux = data["illuminance_by_state"].values[:, 0, int(name[-1])]
    assert facts["sensors"] == data["sensor"].values.tolist()
    expected = lux[:, facts["lit"]].T
    assert np.all(
        np.abs(decoded_illuminance(found) - expected) <= STEP * (1 + expected)
    )
    assert not np.delete(lux, facts["lit"], axis=1).any()


def test_the_page_states_its_quantisation(page):
    words = " ".join(page.xpath("string(//section[@id='storage'])").split())
    assert "at most 0.5 % of the illuminance plus 0.005 lux" in words
    assert "The limits 100, 300, 500, 750, 1,000, 2,000, 3,000 lux are exact" in words


def test_without_states_no_operation_can_be_chosen(room):
    plain = html.document_fromstring(
        offline_page(room.analytic_results(times=room.year(days=2)))
    )
    assert not plain.xpath("//*[@id='operation']")
    assert not plain.xpath("//*[@id='glare']")


@pytest.mark.parametrize(
    ("share", "left", "note"),
    [
        (1.5, False, "The hours of each shade state are left out"),
        (0.5, True, r"\d+ of 81 sensors are shown, evenly spread"),
    ],
)
def test_what_exceeds_the_size_is_left_out_and_named(
    results, page, monkeypatch, share, left, note
):
    """The limit is a multiple of the size of the hours as operated and of glare."""
    needed = len(part(page, "operated")) + len(part(page, "views"))
    monkeypatch.setattr(explore_page, "MOST_BYTES", int(share * needed))
    small = html.document_fromstring(offline_page(results))
    assert re.search(note, small.xpath("string(//p[contains(@class, 'left-out')])"))
    assert not part(small, "state-0-0")
    facts = json.loads(small.xpath("string(//script[@id='data'])"))
    assert (len(facts["sensors"]) < 81) == left
