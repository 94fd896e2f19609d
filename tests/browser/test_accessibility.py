"""Accessibility of the pages by axe-core: no finding of serious or critical impact.

Set CLERESTORY_AXE to the file axe.min.js of axe-core (`npm install axe-core`).
"""

import importlib.util
import json
import os
import re
from pathlib import Path

import pytest

from chromium_probe import ask
from clerestory.bsdf.analytic import clear_air
from clerestory.hemisphere.klems import klems
from clerestory.report.bsdf_view import write_view
from clerestory.report.explore_page import write_explorer
from clerestory.report.page import write_report
from clerestory.report.variants_page import write_variants_page
from clerestory.study.variant_figures import run_figures

UNIT = Path(__file__).parents[1] / "unit" / "report"
MOMENTS = [f"01-03T{hour:02d}:30" for hour in range(7, 18)]

# The page in a frame, which can be as narrow as a phone
FRAMED = """
const frame = document.createElement("iframe");
frame.style = "border: 0; width: WIDTHpx; height: 900px";
frame.srcdoc = PAGE;
document.body.append(frame);
await new Promise(done => { frame.onload = () => setTimeout(done, 2000); });
frame.contentWindow.eval(AXE);
const found = await frame.contentWindow.axe.run({ resultTypes: ["violations"] });
return JSON.stringify({
  scripts: frame.contentDocument.documentElement.dataset.scripts ?? "none",
  passed: found.passes.length,
  found: found.violations.map(each =>
    [each.impact, each.id, each.nodes.map(node => node.html.slice(0, 120))]),
});
"""


@pytest.fixture(scope="session")
def axe():
    """Source text of axe-core."""
    file = os.environ.get("CLERESTORY_AXE")
    if not file:
        pytest.skip("CLERESTORY_AXE names no file axe.min.js of axe-core")
    return Path(file).read_text(encoding="utf-8")


def module(name):
    spec = importlib.util.spec_from_file_location(name, UNIT / f"{name}.py")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


@pytest.fixture(scope="module")
def pages(room, tmp_path_factory):
    """A page of each kind with all of its sections."""
    folder, course = tmp_path_factory.mktemp("pages"), module("course")
    course.write_pictures(folder, MOMENTS)
    month = room.analytic_results(times=room.year(days=30))
    full = course.with_course(month, pictures=MOMENTS)
    grids = module("view_grids")
    full = module("shade_states").with_states(
        grids.with_view_grids(full, grids.grid(2, 3))
    )
    write_report(full, folder / "report.html", pictures=folder)
    write_explorer(full, folder / "explore.html", pictures=folder)
    standards = module("standard_pages").with_standards(month)
    write_report(standards, folder / "standards.html")
    write_view(clear_air(klems("full")), folder / "bsdf.html")
    runs = [run_figures(full, name=name) for name in ("open", "closed")]
    write_variants_page(folder / "variants.html", runs, title="Variants")
    return folder


@pytest.mark.parametrize("width", [1300, 390])
@pytest.mark.parametrize("name", ["report", "explore", "standards", "bsdf", "variants"])
def test_pages_have_no_serious_finding(browse, pages, axe, name, width):
    text = re.sub(r"<meta http-equiv[^>]*>", "", (pages / f"{name}.html").read_text())
    words = f"const AXE = {json.dumps(axe)}, PAGE = {json.dumps(text)};"
    script = (words + FRAMED.replace("WIDTH", str(width))).replace("</", "<\\/")
    empty = pages / "empty.html"
    empty.write_text("<!doctype html><html data-scripts=none><body></body></html>")
    answer = json.loads(ask(browse, empty, script))
    assert answer["scripts"] == ("none" if name == "variants" else "done")
    assert answer["passed"] > 20
    assert [
        each for each in answer["found"] if each[0] in ("serious", "critical")
    ] == []
