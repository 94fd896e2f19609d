"""Radiance matrix files: what is read, what is refused before memory is taken."""

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from clerestory.bands import unnamed_bands
from clerestory.errors import InputError, OutputError
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sensor_axis, sky_axis, unknown_axis
from clerestory.matrix.radiance_format import read_matrix, write_matrix
from clerestory.matrix.transfer_matrix import TransferMatrix

SOUND = "#?RADIANCE\nrmtxop -fa a.mtx\nNROWS=2\nNCOLS=3\nNCOMP=1\nFORMAT=ascii\n\n"
NUMBERS = "1 2 3\n4 5 6\n"


def matrix(channels=3, rows=4, columns=5, dtype=float):
    rng = np.random.default_rng(7)
    values = rng.normal(size=(channels, rows, columns)).astype(dtype)
    axes = unknown_axis(rows), unknown_axis(columns)
    return TransferMatrix(values, *axes, bands=unnamed_bands(channels))


@pytest.fixture
def write(tmp_path):
    def to_file(content):
        path = tmp_path / "a.mtx"
        path.write_bytes(content if isinstance(content, bytes) else content.encode())
        return path

    return to_file


@pytest.mark.parametrize("channels", [1, 3, 9])
@pytest.mark.parametrize(
    ("dtype", "encoding"),
    [(float, "ascii"), (float, "double"), (np.float32, "ascii"), (np.float32, "float")],
)
def test_round_trip_keeps_every_bit(tmp_path, channels, dtype, encoding):
    original = matrix(channels, dtype=dtype)
    write_matrix(
        tmp_path / "a.mtx", original, encoding=encoding, command="made by hand"
    )
    copy = read_matrix(tmp_path / "a.mtx")
    np.testing.assert_array_equal(copy.values.astype(dtype), original.values)
    assert (copy.rows.kind, copy.columns.kind) == ("unknown", "unknown")


def test_components_lie_side_by_side_and_rows_one_after_the_other(write):
    """As in Radiance: for each row, for each column, R G B."""
    header = "#?RADIANCE\nNCOMP=3\nNROWS=2\nNCOLS=2\nFORMAT=ascii\n\n"
    read = read_matrix(write(header + "1 2 3\t4 5 6\n7 8 9\t10 11 12\n"))
    np.testing.assert_array_equal(read.values[0], [[1, 4], [7, 10]])
    np.testing.assert_array_equal(read.values[2], [[3, 6], [9, 12]])


def test_components_may_be_named(write):
    """The file holds their number; one that is alike in all bands fits any."""
    nine = unnamed_bands(9)
    header = "#?RADIANCE\nNCOMP=%d\nNROWS=1\nNCOLS=1\nFORMAT=ascii\n\n"
    assert read_matrix(write(header % 9 + "1 2 3 4 5 6 7 8 9\n")).bands == nine
    assert read_matrix(write(header % 1 + "1\n"), bands=nine).values.shape == (1, 1, 1)
    with pytest.raises(InputError, match="3 components; one, or one for each of the 9"):
        read_matrix(write(header % 3 + "1 2 3\n"), bands=nine)


@pytest.mark.parametrize(("order", "flag"), [("<", 0), (">", 1)])
@pytest.mark.parametrize(("item", "name"), [("f4", "float"), ("f8", "double")])
def test_byte_order_is_that_of_the_header(write, order, flag, item, name):
    data = np.arange(6, dtype=order + item)
    header = (
        f"#?RADIANCE\nNROWS=2\nNCOLS=3\nNCOMP=1\nBigEndian={flag}\nFORMAT={name}\n\n"
    )
    read = read_matrix(write(header.encode() + data.tobytes()))
    np.testing.assert_array_equal(read.values[0], [[0, 1, 2], [3, 4, 5]])
    assert read.values.dtype.isnative


def test_binary_data_may_begin_with_line_ends(write):
    data = np.frombuffer(b"\n\n\n\n" * 2, "<f4")
    header = b"#?RADIANCE\nNROWS=1\nNCOLS=2\nNCOMP=1\nFORMAT=float\n\n"
    np.testing.assert_array_equal(
        read_matrix(write(header + data.tobytes())).values[0, 0], data
    )


def test_rows_are_counted_where_the_header_does_not_say(write):
    text = SOUND.replace("NROWS=2\n", "")
    assert read_matrix(write(text + NUMBERS)).rows.size == 2


def test_three_components_are_the_default(write):
    text = SOUND.replace("NCOMP=1\n", "").replace("NCOLS=3", "NCOLS=1")
    assert read_matrix(write(text + NUMBERS)).values.shape == (3, 2, 1)


def test_windows_line_ends_are_understood(write):
    text = (SOUND + NUMBERS).replace("\n", "\r\n")
    assert read_matrix(write(text)).values.sum() == 21


def test_variables_of_earlier_files_in_the_history_do_not_count(write):
    """Radiance indents what it copies from the headers of its inputs."""
    text = SOUND.replace("NROWS=2", "\tNROWS=99\nNROWS=2") + NUMBERS
    assert read_matrix(write(text)).rows.size == 2


def test_command_cannot_become_a_header_variable(tmp_path):
    original = matrix()
    write_matrix(
        tmp_path / "a.mtx", original, encoding="double", command="NROWS=1\n\nx"
    )
    assert read_matrix(tmp_path / "a.mtx").values.shape == original.values.shape


def test_header_variables_are_written_in_one_line_each(tmp_path):
    write_matrix(
        tmp_path / "a.mtx",
        matrix(),
        header={"PLACE": "OSLO\nNROWS=1"},
        command="x " * 9000,
    )
    lines = (tmp_path / "a.mtx").read_bytes().split(b"\n\n")[0].decode().splitlines()
    assert "PLACE= OSLO NROWS=1" in lines
    assert max(map(len, lines)) < 2047  # the buffer of Radiance's programs
    assert read_matrix(tmp_path / "a.mtx").values.shape == matrix().values.shape


@pytest.mark.parametrize("name", ["NROWS", "FORMAT", "two words", "A=B", ""])
def test_header_variables_cannot_replace_those_of_the_format(tmp_path, name):
    with pytest.raises(InputError, match="header variable is"):
        write_matrix(tmp_path / "a.mtx", matrix(), header={name: "1"})


def test_axes_label_the_matrix(write):
    sky = sky_axis(reinhart(1))
    data = np.ones((2, 146, 3), "<f4").tobytes()
    header = b"#?RADIANCE\nNROWS=2\nNCOLS=146\nNCOMP=3\nFORMAT=float\n\n"
    read = read_matrix(write(header + data), rows=sensor_axis(2), columns=sky)
    assert read.columns.partition.subdivision == 1
    with pytest.raises(InputError, match=r"146 columns; 3 sensors by 146 sky patches"):
        read_matrix(write(header + data), rows=sensor_axis(3), columns=sky)


FAULTS = {
    "no header": (SOUND, "", "does not start with #?RADIANCE"),
    "no empty line": ("ascii\n\n", "ascii\n", "no empty line after the header"),
    "no columns": ("NCOLS=3\n", "", "no NCOLS in the header"),
    "columns in words": ("NCOLS=3", "NCOLS=three", "NCOLS=three; a positive whole"),
    "no rows at all": ("NROWS=2", "NROWS=0", "NROWS=0; a positive whole number"),
    "negative rows": ("NROWS=2", "NROWS=-2", "NROWS=-2; a positive whole number"),
    "huge counts": ("NROWS=2", "NROWS=99999999999", "6 values; 299999999997 expected"),
    "absurd counts": ("NROWS=2", "NROWS=" + "9" * 30, "a positive whole number"),
    "more components": ("NCOMP=1", "NCOMP=20", "6 values; 120 expected for 2 rows of"),
    "a picture": ("FORMAT=ascii", "FORMAT=32-bit_rle_rgbe", "'32-bit_rle_rgbe'"),
    "too few values": ("4 5 6", "4 5", "5 values; 6 expected"),
    "too many values": ("4 5 6", "4 5 6 7", "7 values; 6 expected"),
    "a word": ("4 5 6", "4 five 6", "one value is 'five'"),
    "not a number": ("4 5 6", "4 nan 6", "row 2, column 2 is nan"),
    "infinity": ("4 5 6", "4 5 inf", "row 2, column 3 is inf"),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_faulty_text_is_refused(write, fault):
    old, new, message = FAULTS[fault]
    assert old in SOUND + NUMBERS
    path = write((SOUND + NUMBERS).replace(old, new))
    with pytest.raises(InputError) as caught:
        read_matrix(path)
    assert message in str(caught.value)
    assert str(path) in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("length", [0, 1, 23, 25, 48])
def test_binary_data_of_another_length_are_refused(write, length):
    header = b"#?RADIANCE\nNROWS=2\nNCOLS=3\nNCOMP=1\nFORMAT=float\n\n"
    with pytest.raises(InputError, match=rf"{length} bytes of data; 24 expected"):
        read_matrix(write(header + b"\0" * length))


def test_terabytes_are_refused_before_they_are_taken(write):
    header = b"#?RADIANCE\nNROWS=900000000\nNCOLS=900000000\nNCOMP=3\nFORMAT=double\n\n"
    with pytest.raises(InputError, match="bytes of data"):
        read_matrix(write(header + b"\0" * 100))


def test_infinities_that_cancel_are_found(write):
    data = np.array([np.inf, -np.inf, 1, 1, 1, 1], "<f4").tobytes()
    header = b"#?RADIANCE\nNROWS=2\nNCOLS=3\nNCOMP=1\nFORMAT=float\n\n"
    with pytest.raises(InputError, match="row 1, column 1 is inf"):
        read_matrix(write(header + data))


def test_large_finite_values_are_kept(write):
    data = np.full(6, 1.7e308).tobytes()
    header = b"#?RADIANCE\nNROWS=2\nNCOLS=3\nNCOMP=1\nFORMAT=double\n\n"
    assert read_matrix(write(header + data)).values.max() == 1.7e308


def test_missing_file_is_refused(tmp_path):
    with pytest.raises(InputError, match="cannot be read"):
        read_matrix(tmp_path / "none.mtx")


def test_unknown_encoding_is_refused(tmp_path):
    with pytest.raises(InputError, match="'text'; one of ascii, float, double"):
        write_matrix(tmp_path / "a.mtx", matrix(), encoding="text")


def test_nothing_is_left_in_a_folder_that_cannot_be_written(tmp_path):
    with pytest.raises(OutputError):
        write_matrix(tmp_path / "none" / "a.mtx", matrix())
    assert list(tmp_path.iterdir()) == []


@settings(
    max_examples=200,
    deadline=None,
    suppress_health_check=[HealthCheck.function_scoped_fixture],
)
@given(data=st.data(), encoding=st.sampled_from(["ascii", "float", "double"]))
def test_damaged_files_are_read_or_refused(tmp_path, data, encoding):
    path = tmp_path / "a.mtx"
    write_matrix(path, matrix(rows=2, columns=2), encoding=encoding)
    content = bytearray(path.read_bytes())
    for _ in range(data.draw(st.integers(1, 3))):
        at = data.draw(st.integers(0, len(content) - 1))
        length = data.draw(st.integers(0, 10))
        content[at : at + length] = data.draw(
            st.binary(max_size=5)
            | st.sampled_from([b"9" * 12, b"\n\n", b"-1", b"nan", b"NCOLS=", b"\0"])
        )
    path.write_bytes(bytes(content))
    try:
        read = read_matrix(path)
    except InputError as error:
        message = str(error)
        assert "\n" not in message
        return
    assert np.all(np.isfinite(read.values))
