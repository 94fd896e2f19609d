"""Text files of spectra: accepted forms, and errors with their lines."""

import pytest

from clerestory.errors import InputError
from clerestory.spectral.spectrum_file import read_spectrum


@pytest.mark.parametrize(
    "text",
    [
        "400 0.1\n500 0.3\n",
        "nm,value\n400,0.1\n\n500,0.3",
        "# a paint\n400;0.1 # blue\n500;0.3\n",
        "400\t.1\r\n500\t3e-1\r\n",
    ],
)
def test_columns_may_be_separated_in_several_ways(tmp_path, text):
    file = tmp_path / "paint.csv"
    file.write_text(text, newline="")
    found = read_spectrum(file)
    assert found.wavelength_nm.tolist() == [400, 500]
    assert found.value.tolist() == [0.1, 0.3]


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "no values"),
        ("nm value\n", "no values"),
        ("400 0.1\n500\n", "2: the line is"),
        ("400 0.1\n500 red\n", "2: the line is"),
        ("400 0.1 0.2\n", "1: the line is"),
        ("500 0.1\n400 0.2\n", "increasing"),
        ("400 nan\n", "value"),
        ("-1 0.5\n", "positive"),
        ("a b\nc d\n400 0.1\n", "2: the line is"),
    ],
)
def test_wrong_lines_are_named(tmp_path, text, words):
    file = tmp_path / "paint.csv"
    file.write_text(text)
    with pytest.raises(InputError, match=words) as caught:
        read_spectrum(file)
    assert "paint.csv" in str(caught.value)
