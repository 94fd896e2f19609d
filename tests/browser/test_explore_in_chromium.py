"""The interactive page: the same numbers as the results, by slider and keyboard."""

import importlib.util
import json
import re
import threading
from pathlib import Path

import numpy as np
import pytest
from lxml import html

from clerestory.report.explore_page import write_explorer
from clerestory.report.result_server import ResultServer, resources_of

UNIT = Path(__file__).parents[1] / "unit" / "report"
MOMENTS = [f"06-21T{hour:02d}:30" for hour in range(9, 16)]

# Error of the hours in the page: a part of 1 lux + illuminance
ERROR = 0.005


def module(name):
    spec = importlib.util.spec_from_file_location(name, UNIT / f"{name}.py")
    loaded = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(loaded)
    return loaded


@pytest.fixture(scope="module")
def results(room):
    full = module("course").with_course(room.analytic_results(), pictures=MOMENTS)
    grids = module("view_grids")
    return module("shade_states").with_states(
        grids.with_view_grids(full, grids.grid(2, 3))
    )


@pytest.fixture(scope="module")
def page(results, tmp_path_factory):
    folder = tmp_path_factory.mktemp("explore")
    module("course").write_pictures(folder, MOMENTS)
    write_explorer(results, folder / "explore.html", pictures=folder)
    return folder / "explore.html"


def probed(page, script):
    """A copy of the page with one more script, which its policy would forbid."""
    text = re.sub(r"<meta http-equiv[^>]*>", "", page.read_text(encoding="utf-8"))
    probe = (
        "const pause = ms => new Promise(done => setTimeout(done, ms));"
        "const set = async (name, value, event = 'change') => {"
        " const field = document.getElementById(name); field.value = value;"
        " field.dispatchEvent(new Event(event, {bubbles: true}));"
        " await pause(150); };"
        "const wait = setInterval(async () => {"
        " if (!document.documentElement.dataset.scripts) return;"
        " clearInterval(wait);"
        f" document.title = JSON.stringify(await (async () => {{ {script} }})());"
        " }, 50);"
    )
    copy = page.with_name("probe.html")
    copy.write_text(
        text.replace("</body>", f"<script>{probe}</script></body>"), "utf-8"
    )
    return copy


def ask(browse, page, script, *options):
    dom = browse(probed(page, script), "--dump-dom", *options)
    return json.loads(html.document_fromstring(dom).xpath("string(//title)"))


@pytest.fixture(scope="module")
def shown(browse, page):
    """What the page shows after a series of changes."""
    return ask(
        browse,
        page,
        """const found = {}, year = () => [...explorer.shownYear.values];
        found.autonomy = year();
        await set("low", 500, "input"); found.at500 = year();
        await set("low", 437, "input"); found.at437 = year();
        await set("low", 300, "input");
        await set("metric", "useful"); found.useful = year();
        await set("metric", "mean"); found.mean = year();
        await set("metric", "continuous"); found.continuous = year();
        await set("metric", "autonomy");
        await set("hours", "own"); await set("from-hour", 10, "input");
        found.from10 = year(); await set("hours", "study");
        await set("date", 171, "input"); await set("hour", 12, "input");
        found.moment = [...explorer.shownMoment.values];
        found.momentWords = document.getElementById("moment-words").textContent;
        found.picture = document.querySelector("#picture-0 .said").textContent;
        found.csv = csvLines(explorer, explorer.shownMoment);
        found.png = (await explorer.year.picture(["title"])).size;
        await set("dgp-limit", 0.45, "input");
        const exceeded = () => document.getElementById("exceeded-0").textContent;
        await set("kind-a", "all:2"); found.closed = year();
        found.glareClosed = exceeded();
        await set("kind-a", "rule"); await set("rule-limit-a", 150);
        found.rule = year(); found.glareRule = exceeded();
        await set("kind-a", "operated"); await set("shown", "difference");
        found.difference = year(); found.glareBoth = exceeded();
        await set("shown", "a");
        found.glare = document.getElementById("exceeded-0").textContent;
        found.positions = [...explorer.shownPositions.values];
        await set("direction", 4, "input");
        found.south = [...explorer.shownPositions.values];
        found.southWords = document.getElementById("direction").selectedOptions[0].text;
        await set("grid", 1); found.eyes = explorer.shownYear.values.length;
        document.getElementById("values").open = true; await pause(300);
        found.rows = document.querySelectorAll("#values-rows tr").length;
        return found;""",
    )


@pytest.fixture(scope="module")
def occupied(results):
    """Illuminance of the desks in the occupied hours, as operated and open."""
    data = results.data
    desks = (data["grid"] == "desks").values
    hours = data["occupied"].values
    lux = data["illuminance"].values[desks][:, hours].astype(float)
    opened = data["illuminance_by_state"].values[desks][:, 0, :, hours]
    return lux, np.moveaxis(opened, 0, -1).astype(float), hours


def share(reached):
    return 100 * reached.mean(axis=-1)


def test_metrics_with_exact_limits_are_those_of_the_file(shown, occupied):
    lux, _, _ = occupied
    assert np.allclose(shown["autonomy"], share(lux >= 300), atol=1e-9)
    assert np.allclose(shown["at500"], share(lux >= 500), atol=1e-9)
    useful = (lux >= 300) & (lux < 3000)
    assert np.allclose(shown["useful"], share(useful), atol=1e-9)


def test_other_limits_are_within_the_quantisation(shown, occupied):
    lux, _, _ = occupied
    margin = ERROR * 438
    most, least = (share(lux >= 437 + side * margin) for side in (-1, 1))
    assert np.all((shown["at437"] >= least - 1e-9) & (shown["at437"] <= most + 1e-9))


def test_means_are_those_of_the_file(shown, occupied):
    lux, _, _ = occupied
    mean = lux.mean(axis=1)
    assert np.all(np.abs(shown["mean"] - mean) <= ERROR * (1 + mean))
    partly = 100 * np.minimum(lux / 300, 1).mean(axis=1)
    assert np.allclose(shown["continuous"], partly, atol=0.5)


def test_other_hours_than_those_of_the_study(shown, results):
    data = results.data
    desks = (data["grid"] == "desks").values
    hour = data["time"].dt.hour.values
    chosen = (hour >= 10) & (hour < 18)
    lux = data["illuminance"].values[desks][:, chosen]
    assert np.allclose(shown["from10"], share(lux >= 300), atol=1e-9)


def test_a_moment_shows_its_hour(shown, results):
    data = results.data
    desks = (data["grid"] == "desks").values
    step = int(np.argmax(data["time"].values == np.datetime64("2023-06-21T12:30")))
    lux = data["illuminance"].values[desks, step]
    assert np.all(np.abs(np.array(shown["moment"]) - lux) <= ERROR * (1 + lux))
    assert shown["momentWords"].startswith("21 June 12:30: ")
    assert "south tilted" in shown["momentWords"]
    assert shown["picture"] == "21 June 12:30"


def test_states_rules_and_their_difference(shown, occupied, results):
    """Closed always; closed above 150 W/m²; and always open less as operated."""
    lux, states, hours = occupied
    assert np.allclose(shown["closed"], share(states[:, 2] >= 300), atol=1e-9)
    outside = results.data["facade_irradiance"].values[0, hours].round(1)
    ruled = np.where(outside > 150, states[:, 1], states[:, 0])
    assert np.allclose(shown["rule"], share(ruled >= 300), atol=1e-9)
    expected = share(states[:, 0] >= 300) - share(lux >= 300)
    assert np.allclose(shown["difference"], expected, atol=1e-9)
    assert expected.max() > 1


def test_glare_is_that_of_the_file(shown, results):
    data = results.data
    hours = data["occupied"].values
    desk = data["glare_dgp"].values[0, hours] > 0.45
    assert shown["glare"] == f"{100 * desk.mean():.1f} %"
    grid = data["grid_view_dgp"].values[:, hours] > 0.45
    shares = share(grid).reshape(6, 8)
    assert np.allclose(shown["positions"], shares.max(axis=1), atol=1e-9)
    assert np.allclose(shown["south"], shares[:, 4], atol=1e-9)
    assert shown["southWords"] == "180°"


def test_glare_of_states_and_rules_is_that_of_the_file(shown, results):
    """Closed always; closed above 150 W/m²; and as operated beside always open."""
    data = results.data
    hours = data["occupied"].values
    dgp = data["glare_dgp_by_state"].values[0][:, hours]
    ruled = data["facade_irradiance"].values[0, hours].round(1) > 150
    expected = [dgp[2], np.where(ruled, dgp[1], dgp[0])]
    found = [shown["glareClosed"], shown["glareRule"]]
    assert found == [f"{share(each > 0.45):.1f} %" for each in expected]
    opened = f"{share(dgp[0] > 0.45):.1f} %"
    assert shown["glareBoth"] == f"A {shown['glare']}, B {opened}"


def test_downloads_hold_what_is_shown(shown, results):
    head, first, *others = shown["csv"]
    assert head.startswith('sensor,x [m],y [m],z [m],"Illuminance of desks, 21 June')
    assert len(others) + 1 == len(shown["moment"])
    name, x, y, z, value = first.split(",")
    assert name == "desks.1"
    assert np.allclose(
        [float(x), float(y), float(z)], results.data["position"][0], atol=5e-4
    )
    assert np.isclose(float(value), shown["moment"][0], rtol=1e-4)
    assert shown["png"] > 10_000


def test_another_grid_and_its_table(shown):
    assert shown["eyes"] == shown["rows"] == 4


def test_scripts_run_under_the_policy_of_the_page(browse, page):
    dom = html.document_fromstring(browse(page, "--dump-dom"))
    assert dom.get("data-scripts") == "done"
    assert dom.get("data-error") is None


def test_the_served_page_reads_its_values_from_the_server(browse, page, results):
    resources = resources_of(results, pictures=page.parent)
    assert {"part/operated", "part/state-0-2", "part/view-grid-0"} < set(resources)
    with ResultServer(resources) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        dom = html.document_fromstring(browse(server.address, "--dump-dom"))
        server.shutdown()
    assert dom.get("data-error") is None
    assert dom.get("data-scripts") == "done"
    words = dom.xpath("string(//*[@id='year-words'])")
    assert re.match(r"Hours with 300 lux or more: \d\d\.\d % on average", words)
    assert dom.xpath("//*[@id='picture-0']//img/@src")[0].startswith("picture/0-")


def test_every_control_has_a_name_and_the_page_fits_a_phone(browse, page):
    """At 390 px nothing is cut off; controls have labels, drawings have names."""
    nameless, wide = ask(
        browse,
        page,
        """document.body.style.width = "390px"; await pause(100);
        const all = [...document.querySelectorAll("input, select, button, svg.plan")];
        const named = c => (c.labels && c.labels.length) || c.getAttribute("aria-label")
          || (c.tagName === "BUTTON" && c.textContent);
        const wide = [...document.querySelectorAll("main *")].filter(e =>
          e.getBoundingClientRect().right > 391 && !e.closest(".wide, svg, [hidden]"));
        const names = found => found.map(e => e.id || e.tagName);
        return [names(all.filter(c => !named(c))), names(wide)];""",
        "--window-size=500,900",
    )
    assert nameless == []
    assert wide == []


def test_the_page_prints_without_its_controls(browse, page, tmp_path):
    file = tmp_path / "explore.pdf"
    browse(page, "--no-pdf-header-footer", f"--print-to-pdf={file}")
    assert 1 <= len(re.findall(rb"/Type\s*/Page\b", file.read_bytes())) <= 5


def test_hostile_names_run_no_script(browse, room, tmp_path):
    title = '</script><script>document.title="broken"</script><img src=x onerror=a()>'
    page = tmp_path / "explore.html"
    write_explorer(room.analytic_results(times=room.year(days=2), title=title), page)
    dom = html.document_fromstring(browse(page, "--dump-dom"))
    assert dom.get("data-scripts") == "done"
    assert dom.xpath("string(//title)").startswith("</script>")
    assert not dom.xpath("//main//img")
