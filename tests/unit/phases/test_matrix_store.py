"""The store finds matrices again, to the bit, and does not trust damaged files."""

import numpy as np
import pytest

from clerestory.errors import ClerestoryWarning, OutputError
from clerestory.hemisphere.klems import klems
from clerestory.hemisphere.reinhart import reinhart
from clerestory.matrix.axis import sky_axis, window_axis
from clerestory.matrix.transfer_matrix import TransferMatrix
from clerestory.phases.matrix_store import MatrixStore

KEY = "0123456789abcdef" * 4
OTHER_KEY = "f123456789abcdef" * 4


def daylight(seed=0, dtype=np.float64):
    rng = np.random.default_rng(seed)
    values = rng.random((3, 145, 146)).astype(dtype) * 1e-3
    rows = window_axis("exterior", klems("full"), "south")
    components = rng.normal(size=(4, *values.shape)).astype(np.float32)
    return TransferMatrix(values, rows, sky_axis(reinhart(1)), components)


class Tracer:
    """Counts how often something is traced."""

    def __init__(self, matrix):
        self.matrix, self.count = matrix, 0

    def __call__(self):
        self.count += 1
        return self.matrix


@pytest.fixture
def store(tmp_path):
    return MatrixStore(tmp_path / "matrices")


def assert_same_bits(one, other):
    assert one.values.dtype == other.values.dtype
    assert one.values.tobytes() == other.values.tobytes()
    assert one.components.dtype == other.components.dtype
    assert one.components.tobytes() == other.components.tobytes()
    assert one.rows.describe() == other.rows.describe()
    assert one.rows.fits(other.rows)
    assert one.columns.fits(other.columns)


@pytest.mark.parametrize("dtype", [np.float64, np.float32])
def test_a_matrix_is_found_again_to_the_bit(store, dtype):
    trace = Tracer(daylight(dtype=dtype))
    first = store.matrix("daylight-south", KEY, trace)
    second = MatrixStore(store.folder).matrix("daylight-south", KEY, trace)
    assert trace.count == 1
    assert_same_bits(first, trace.matrix)
    assert_same_bits(second, trace.matrix)


def test_another_fingerprint_is_traced_again(store):
    store.matrix("view", KEY, Tracer(daylight(1)))
    trace = Tracer(daylight(2))
    assert_same_bits(store.matrix("view", OTHER_KEY, trace), trace.matrix)
    assert trace.count == 1
    assert len(list(store.folder.iterdir())) == 2


def test_the_same_matrix_is_kept_as_the_same_bytes(store, tmp_path):
    other = MatrixStore(tmp_path / "other")
    for place in (store, other):
        place.matrix("view", KEY, Tracer(daylight()))
    paths = [place.path("view", KEY) for place in (store, other)]
    assert paths[0].read_bytes() == paths[1].read_bytes()


def cut(content):
    return content[: len(content) // 2]


def flip(content):
    middle = len(content) // 2
    return content[:middle] + bytes([content[middle] ^ 4]) + content[middle + 1 :]


def empty(_content):
    return b""


@pytest.mark.parametrize("damage", [cut, flip, empty])
def test_a_damaged_file_is_traced_again_with_a_warning_that_names_it(store, damage):
    store.matrix("view", KEY, Tracer(daylight()))
    path = store.path("view", KEY)
    path.write_bytes(damage(path.read_bytes()))
    trace = Tracer(daylight())
    with pytest.warns(ClerestoryWarning, match=f"{path.name} is damaged"):
        again = store.matrix("view", KEY, trace)
    assert trace.count == 1
    assert_same_bits(again, trace.matrix)
    store.matrix("view", KEY, trace)
    assert trace.count == 1


def test_tracing_that_fails_leaves_nothing_behind(store):
    def killed():
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        store.matrix("view", KEY, killed)
    assert list(store.folder.iterdir()) == []


def test_matrices_traced_together_are_traced_again_together(store):
    made = {"view-a": daylight(1), "view-b": daylight(2)}
    trace = Tracer(made)
    store.matrices(list(made), KEY, trace)
    store.path("view-b", KEY).unlink()
    again = store.matrices(list(made), KEY, trace)
    assert trace.count == 2
    for name, matrix in made.items():
        assert_same_bits(again[name], matrix)


def test_a_folder_that_cannot_be_made_is_an_output_error(tmp_path):
    (tmp_path / "file").write_text("")
    trace = Tracer(daylight())
    with pytest.raises(OutputError, match="cannot be made"):
        MatrixStore(tmp_path / "file" / "matrices").matrix("view", KEY, trace)
    assert trace.count == 0


def test_names_with_awkward_characters_stay_in_the_folder(store):
    assert store.path("view-../south wing/1", KEY).parent == store.folder
