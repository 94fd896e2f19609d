"""Lines of keys in TOML of every form."""

import tomllib

import pytest

from clerestory.toml_lines import key_lines, line_of

TEXT = '''# comment
title = "a"   # key = 3

[scene]
files = [
  "x = 1",   # ]
  "[not a table]",
]
"quoted key" = 1
[trace.deep]
note = """
samples = 3
"""
samples = 4
[[window]]
name = "one"
[[window]]
name = "two"
inline = { a = 1, b = { c = 2 } }
[window.more]
x.y = 5
'''


@pytest.mark.parametrize(
    ("path", "line"),
    [
        (("title",), 2),
        (("scene",), 4),
        (("scene", "files"), 5),
        (("scene", "files", 1), 5),
        (("scene", "quoted key"), 9),
        (("trace", "deep"), 10),
        (("trace", "deep", "note"), 11),
        (("trace", "deep", "samples"), 14),
        (("window",), 15),
        (("window", 0, "name"), 16),
        (("window", 1), 17),
        (("window", 1, "name"), 18),
        (("window", 1, "inline", "b", "c"), 19),
        (("window", 1, "more", "x", "y"), 21),
    ],
)
def test_each_key_has_its_line(path, line):
    tomllib.loads(TEXT)
    assert key_lines(TEXT)[path] == line


def test_a_missing_key_stands_where_its_table_does():
    lines = key_lines(TEXT)
    assert line_of(("window", 1, "file"), lines) == 17
    assert line_of(("nowhere", "at all"), lines) is None


def test_an_empty_text_has_no_keys():
    assert key_lines("\n# nothing\n") == {}
