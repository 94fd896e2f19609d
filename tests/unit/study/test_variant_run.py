"""Runs of all variants: shared matrices, equal results, differences with errors."""

import json

import numpy as np
import pytest
import xarray as xr

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.report.variants_page import write_variants_page
from clerestory.study.results import read_results
from clerestory.study.study_run import run_study
from clerestory.study.variant_figures import common_keys, figure_rows
from clerestory.study.variant_run import FINISHED_FILE, run_variants
from clerestory.study.variants import read_variants

SWEEP = '\n[sweep]\nglass = ["diffuser", "half", "diffuser2"]\n'


@pytest.fixture
def sweep(study_file):
    """Three glasses: of 0.5, 0.25 and again 0.5 transmittance."""
    for name, share in (("half", 0.25), ("diffuser2", 0.5)):
        write_bsdf(
            study_file.parent / f"{name}.xml", lambertian(share, klems("quarter"))
        )
    text = study_file.read_text().replace('"diffuser.xml"', '"{glass}.xml"')
    study_file.write_text(text + SWEEP)
    return study_file


def test_shared_matrices_are_traced_once(sweep, engine, tmp_path):
    run_variants(read_variants(sweep), out=tmp_path / "out")
    assert sorted(engine.calls) == ["daylight", "view"]


def test_a_variant_has_the_results_of_its_own_run(sweep, engine, tmp_path):
    variants = read_variants(sweep)
    run_variants(variants, out=tmp_path / "out")
    alone = run_study(variants[1].study, out=tmp_path / "alone").data
    shared = read_results(tmp_path / "out" / "half").data
    for name in ("illuminance", "standard_error", "mean_illuminance_components"):
        np.testing.assert_array_equal(shared[name].values, alone[name].values)


def test_variants_that_face_other_directions_have_suns_of_their_own(
    study_file, engine, tmp_path
):
    text = study_file.read_text().replace('"3-phase"', '"2-phase"')
    window = '[[window]]\nname = "south"\nfile = "window.rad"\nbsdf = "diffuser.xml"\n'
    assert window in text
    text = text.replace(window, "") + "\n[sweep]\nsky.rotation_deg = [0.0, 90.0]\n"
    study_file.write_text(text)
    variants = read_variants(study_file)
    run_variants(variants, out=tmp_path / "out")
    alone = run_study(variants[1].study, out=tmp_path / "alone").data
    shared = read_results(tmp_path / "out" / variants[1].name).data
    for name in ("illuminance", "direct_open"):
        np.testing.assert_array_equal(shared[name].values, alone[name].values)


def test_differences_of_runs_that_share_noise_have_paired_errors(
    sweep, engine, tmp_path
):
    """V T D is linear in T: half the transmittance gives half the error, not more."""
    runs = run_variants(read_variants(sweep), out=tmp_path / "out")
    rows = figure_rows(runs, ("mean illuminance", "desk"))
    (first, _), (half, half_change), (_, same_change) = rows
    assert half.value == pytest.approx(first.value / 2, rel=1e-4)
    assert half_change.error == pytest.approx(first.error / 2, rel=0.02)
    assert half_change.error < 0.5 * np.hypot(first.error, half.error)
    assert abs(same_change.value) < 1e-9 * first.value
    assert same_change.error < 1e-9 * first.value


def test_finished_variants_are_not_run_again(sweep, engine, tmp_path, monkeypatch):
    out = tmp_path / "out"
    first = run_variants(read_variants(sweep), out=out)

    def refuse(*_given, **_named):
        raise AssertionError("a finished variant is run again")

    monkeypatch.setattr("clerestory.study.variant_run.run_method", refuse)
    again = run_variants(read_variants(sweep), out=out)
    assert [f.value for f in again[1].figures] == [f.value for f in first[1].figures]

    # A changed input file is noticed
    changed = lambertian(0.3, klems("quarter"))
    write_bsdf(sweep.parent / "half.xml", changed)
    with pytest.raises(AssertionError, match="run again"):
        run_variants(read_variants(sweep), out=out)
    (out / FINISHED_FILE).write_text("{damaged")
    with pytest.raises(AssertionError, match="run again"):
        run_variants(read_variants(sweep), out=out)


def test_built_in_products_are_variants(study_file, engine, tmp_path):
    """Their names are not paths: nothing is read from the folder of the study."""
    window = study_file.with_name("window.rad")
    window.write_text(window.read_text().replace("h=kq", "h=kf"))
    text = study_file.read_text().replace('"diffuser.xml"', '"library:{glass}"')
    text += '\n[sweep]\nglass = ["diffuser-30", "diffuser-80"]\n'
    study_file.write_text(text)
    runs = run_variants(read_variants(study_file), out=tmp_path / "out")
    rows = figure_rows(runs, ("mean illuminance", "desk"))
    assert 2 < rows[1][0].value / rows[0][0].value < 3  # .80 to .30
    finished = json.loads((tmp_path / "out" / FINISHED_FILE).read_text())
    assert sorted(finished) == ["diffuser-30", "diffuser-80"]
    assert len(set(finished.values())) == 2


def test_figures_of_all_variants_are_in_a_table_and_in_netcdf(sweep, engine, tmp_path):
    out = tmp_path / "out"
    runs = run_variants(read_variants(sweep), out=out)
    lines = (out / "variants.csv").read_text().splitlines()
    assert lines[0].startswith("variant,glass,figure,place,unit,value,standard error")
    assert len(lines) == 1 + 3 * len(common_keys(runs))
    with xr.open_dataset(out / "variants.nc", engine="h5netcdf") as data:
        assert data["variant"].values.tolist() == ["diffuser", "half", "diffuser2"]
        norm = np.linalg.norm(data["components"].values, axis=-1)
        known = np.isfinite(norm)
        np.testing.assert_allclose(norm[known], data["error"].values[known], rtol=1e-6)
    assert json.loads((out / FINISHED_FILE).read_text()).keys() == {
        "diffuser",
        "half",
        "diffuser2",
    }


def test_names_of_variants_are_escaped_in_the_page(sweep, engine, tmp_path):
    text = sweep.read_text().replace(SWEEP, "").replace("{glass}", "half")
    text += '\n[[variant]]\nname = "<b>../x</b>"\ntrace.seed = 8\n'
    sweep.write_text(text)
    out = tmp_path / "out"
    runs = run_variants(read_variants(sweep), out=out)
    page = tmp_path / "page.html"
    write_variants_page(page, runs, title="<i>")
    shown = page.read_text()
    assert "<b>../x" not in shown
    assert "&lt;b&gt;../x" in shown
    assert all(folder.parent == out for folder in out.iterdir())


def test_one_run_cannot_be_compared(sweep, engine, tmp_path):
    runs = run_variants(read_variants(sweep)[:1], out=tmp_path / "out")
    with pytest.raises(InputError, match="two or more expected"):
        common_keys(runs)
