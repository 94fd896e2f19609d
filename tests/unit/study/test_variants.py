"""Variants of a study: keys overridden, products of lists, errors with lines."""

import re

import pytest

from clerestory.bsdf.analytic import lambertian
from clerestory.bsdf.xml_writer import write_bsdf
from clerestory.errors import InputError
from clerestory.hemisphere.klems import klems
from clerestory.study.config import read_study
from clerestory.study.variants import MOST_VARIANTS, read_variants


def extended(study_file, more):
    study_file.write_text(study_file.read_text() + more)
    return study_file


def complaint(study_file, more):
    with pytest.raises(InputError) as caught:
        read_variants(extended(study_file, more))
    assert "\n" not in str(caught.value)
    return str(caught.value)


def line_of(study_file, words):
    lines = study_file.read_text().splitlines()
    return next(n for n, line in enumerate(lines, 1) if words in line)


@pytest.fixture
def layers(study_file):
    for name, share in (("dark", 0.1), ("bright", 0.6)):
        layer = lambertian(share, klems("quarter"))
        write_bsdf(study_file.parent / f"{name}.xml", layer)
    return study_file


def test_a_study_without_variants_is_its_only_variant(study_file):
    (only,) = read_variants(study_file)
    assert (only.name, only.settings) == ("", {})
    assert only.study.to_json() == read_study(study_file).to_json()


def test_keys_of_a_variant_replace_those_of_the_study(layers):
    extended(
        layers,
        """
[[variant]]
name = "dark, few samples"
window.bsdf = "dark.xml"
trace.samples = 16

[[variant]]
name = "long day"
schedule = { to_hour = 20 }
[variant.metrics]
target_lux = 500
""",
    )
    base, dark, long = (variant.study for variant in read_variants(layers))
    assert base.window[0].bsdf.name == "diffuser.xml"
    assert dark.window[0].bsdf.name == "dark.xml"
    assert dark.trace.samples == 16
    assert dark.trace.seed == base.trace.seed
    assert (long.schedule.from_hour, long.schedule.to_hour) == (8, 20)
    assert long.metrics.target_lux == 500
    assert long.window[0].bsdf.name == "diffuser.xml"


def test_a_table_of_a_list_is_changed_by_its_name(study_file):
    extended(
        study_file,
        '[[variant]]\nname = "few"\nsensors.eye.name = "look"\n',
    )
    _, few = read_variants(study_file)
    assert [table.label for table in few.study.sensors] == ["desk", "look"]


def test_a_new_control_rule_replaces_the_keys_of_the_old_one(layers):
    states = '[[window.state]]\nname = "a"\nbsdf = "dark.xml"\n'
    states += '[[window.state]]\nname = "b"\nbsdf = "bright.xml"\n'
    text = layers.read_text().replace('bsdf = "diffuser.xml"\n', states, 1)
    assert states in text
    rule = '[window.control]\nrule = "threshold"\nclose_above = 200\n'
    layers.write_text(text.replace(states, states + rule))
    extended(layers, '[[variant]]\nname = "open"\nwindow.control = { rule = "fixed",')
    extended(layers, ' state = "a" }\n')
    base, fixed = (variant.study.window[0].control for variant in read_variants(layers))
    assert (base.rule, fixed.rule, fixed.state) == ("threshold", "fixed", "a")


def test_a_sweep_is_the_product_of_its_lists(layers):
    text = layers.read_text().replace('"diffuser.xml"', '"{glass}.xml"')
    layers.write_text(text)
    extended(
        layers,
        """
[sweep]
glass = ["dark", "bright"]
sky.rotation_deg = [0.0, 90.0, 180.0]

[[sweep.day]]
name = "short"
schedule.to_hour = 15

[[sweep.day]]
name = "long"
schedule.to_hour = 20
""",
    )
    found = read_variants(layers)
    assert len(found) == 12
    assert len({variant.name for variant in found}) == 12
    last = found[-1]
    assert last.settings == {
        "glass": "bright",
        "sky.rotation_deg": "180.0",
        "day": "long",
    }
    assert last.study.window[0].bsdf.name == "bright.xml"
    assert last.study.sky.rotation_deg == 180
    assert last.study.schedule.to_hour == 20
    assert found[0].name == "dark, sky.rotation_deg 0.0, short"


def test_a_number_in_place_of_a_text_is_a_number(study_file):
    text = study_file.read_text().replace("samples = 256", 'samples = "{effort}"')
    study_file.write_text(text)
    extended(study_file, "[sweep]\neffort = [16, 64]\n")
    samples = [variant.study.trace.samples for variant in read_variants(study_file)]
    assert samples == [16, 64]


def test_lists_are_named_by_what_differs(layers):
    for name in ("light", "grim"):
        (layers.parent / f"{name}.rad").write_text("void plastic x 0 0 5 0 0 0 0 0\n")
    more = (
        '[sweep]\nscene.files = [["light.rad", "room.rad"], ["grim.rad", "room.rad"]]\n'
    )
    names = [variant.name for variant in read_variants(extended(layers, more))]
    assert names == ["light", "grim"]


# Text after the study, words of the line complained of, words of the message
WRONG = {
    "wrong value": (
        '[[variant]]\nname = "a"\ntrace.samples = "many"\n',
        "many",
        'variant "a": trace.samples is "many"; a whole number expected',
    ),
    "unknown key": (
        '[[variant]]\nname = "a"\ntrace.sample = 3\n',
        "trace.sample = 3",
        'variant "a": unknown key "trace.sample"',
    ),
    "missing file": (
        '[[variant]]\nname = "a"\nwindow.bsdf = "none.xml"\n',
        "none.xml",
        'variant "a": window[1].bsdf is "none.xml"; the name of a file that exists',
    ),
    "no name": ("[[variant]]\ntrace.seed = 3\n", "[[variant]]", "a name in quotes"),
    "name of the base": (
        '[[variant]]\nname = "base"\n',
        "[[variant]]",
        "several variants are named 'base'; unique names expected",
    ),
    "a table": ("[variant]\nx = 3\n", "[variant]", "tables [[variant]] expected"),
    "both": (
        '[[variant]]\nname = "a"\n[sweep]\ntrace.seed = [1]\n',
        "[[variant]]",
        "both [[variant]] and [sweep]; one of them expected",
    ),
    "no list": ("[sweep]\ntrace.seed = 3\n", "trace.seed = 3", "a list of values"),
    "wrong value of a sweep": (
        "[sweep]\ntrace.seed = [\n1,\n'x']\n",
        "trace.seed",
        'variant "x": trace.seed is "x"; a whole number expected',
    ),
    "unknown axis": (
        "[sweep]\ntilt = [1, 2]\n",
        "tilt = ",
        'a key of the study, or a text of the study with "{tilt}" expected',
    ),
    "no axis": ("[sweep]\n", "[sweep]", "[sweep] has no axis; a list of values"),
    "empty list": ("[sweep]\ntrace.seed = []\n", "trace.seed", "a list of values"),
    "too many": (
        f"[sweep]\ntrace.seed = {list(range(MOST_VARIANTS + 1))}\n",
        "[sweep]",
        "at most 1,000 expected",
    ),
}


@pytest.mark.parametrize("case", WRONG)
def test_a_wrong_variant_is_answered_by_its_line(study_file, case):
    more, place, words = WRONG[case]
    message = complaint(study_file, f"\n{more}")
    assert words in message
    line = int(re.search(r"study\.toml:(\d+):", message)[1])
    assert line == line_of(study_file, place)


def test_read_study_refers_to_the_reader_of_variants(study_file):
    extended(study_file, '\n[[variant]]\nname = "a"\n')
    with pytest.raises(InputError, match="`read_variants` expected"):
        read_study(study_file)
