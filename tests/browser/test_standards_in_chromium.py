"""Sections on standards as people see them: on a phone, by keyboard, printed."""

import importlib.util
from pathlib import Path

import pytest

from chromium_probe import ask
from clerestory.report.page import write_report


@pytest.fixture(scope="module")
def page(room, tmp_path_factory):
    """Report of two months with five standards."""
    file = Path(__file__).parents[1] / "unit" / "report" / "standard_pages.py"
    spec = importlib.util.spec_from_file_location("standard_pages", file)
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    results = module.with_standards(room.analytic_results(times=room.year(days=60)))
    path = tmp_path_factory.mktemp("standards") / "report.html"
    write_report(results, path)
    return path


def in_frame(width, script):
    """Open the page in a frame of a width, and run a script with its `page`."""
    return (
        "const frame = document.createElement('iframe'); frame.style.border = 0;"
        f"frame.style.width = '{width}px'; frame.style.height = '800px';"
        "frame.srcdoc = document.documentElement.outerHTML"
        ".replace(/<script>const wait[^]*/, '');"
        "document.body.append(frame);"
        "await new Promise(done => frame.onload = () => setTimeout(done, 300));"
        f"const page = frame.contentDocument; {script}"
    )


def test_on_a_phone_wide_tables_say_that_they_scroll_and_the_page_does_not(
    browse, page
):
    answer = ask(
        browse,
        page,
        in_frame(
            390,
            "const hints = [...page.querySelectorAll('.standard .scroll-hint')];"
            "const wide = [...page.querySelectorAll('.standard .scrolls')];"
            "const body = page.documentElement;"
            "return [hints.filter(h => !h.hidden).length, wide.length,"
            " wide.every(w => w.tabIndex === 0),"
            " body.scrollWidth <= body.clientWidth + 2].join(' ');",
        ),
    )
    hints, wide, focusable, fits = answer.split()
    assert int(hints) == int(wide) > 4
    assert (focusable, fits) == ("true", "true")


def test_on_a_desktop_no_hint_is_shown(browse, page):
    answer = ask(
        browse,
        page,
        in_frame(
            1300,
            "return [...page.querySelectorAll('.standard .scroll-hint')]"
            ".filter(h => !h.hidden).length;",
        ),
    )
    assert answer == "0"


def test_addresses_within_the_page_exist(browse, page):
    answer = ask(
        browse,
        page,
        "return [...document.querySelectorAll('.standard a, .standards a, nav a')]"
        ".filter(a => !document.querySelector(a.getAttribute('href'))).length;",
    )
    assert answer == "0"
