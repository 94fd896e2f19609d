"""Run-length codes: what is written is read, what is broken is refused."""

import contextlib

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from clerestory.errors import InputError
from clerestory.image import run_length
from clerestory.image.run_length import encode

BYTES = st.sampled_from([0, 1, 2, 127, 128, 129, 255])


def decode(data, *, rows, width):
    blocks = [*run_length.decode(data, rows=rows, width=width)]
    return np.concatenate(blocks)


def as_array(data):
    return np.frombuffer(bytes(data), dtype=np.uint8)


@given(
    st.tuples(st.integers(1, 4), st.integers(1, 300)).flatmap(
        lambda shape: arrays(np.uint8, (*shape, 4), elements=BYTES, fill=BYTES)
    )
)
@settings(max_examples=150)
def test_what_is_written_is_read(pixels):
    rows, width, _ = pixels.shape
    if width < 8:
        pixels[..., 3] = 130  # the plain form leaves 1 1 1 n to the old code
        pixels[..., 0] = 200
    assert np.array_equal(
        decode(as_array(encode(pixels)), rows=rows, width=width), pixels
    )


def test_equal_pixels_are_written_short():
    pixels = np.full((1, 508, 4), 7, dtype=np.uint8)
    # head, and for each component four runs of 127
    assert len(encode(pixels)) == 4 + 4 * 4 * 2


def test_both_ways_to_find_codes_agree():
    rng = np.random.default_rng(1)
    pixels = rng.choice([2, 0, 90], size=(40, 90, 4), p=[0.1, 0.1, 0.8])
    data = as_array(encode(pixels.astype(np.uint8)))
    together = run_length._find_together(data, 0, 40, 90)
    in_order = run_length._find_in_order(data, 0, 40, 90)
    for a, b in zip(together, in_order, strict=True):
        assert np.array_equal(a, b)


def test_pixels_that_look_like_heads_are_read():
    """Literals that hold 2 2 0 10 again and again must not confuse."""
    pixels = np.tile(np.array([2, 2, 0, 10], dtype=np.uint8), 200).reshape(20, 4, 10)
    pixels = pixels.transpose(0, 2, 1)
    data = as_array(encode(pixels))
    assert run_length._find_together(data, 0, 20, 10) is None
    assert np.array_equal(decode(data, rows=20, width=10), pixels)


def test_old_runs_repeat_the_last_pixel():
    red, blue = [200, 0, 0, 130], [0, 0, 200, 130]
    data = as_array([*red, 1, 1, 1, 3, *blue, *red, 1, 1, 1, 2, 1, 1, 1, 0, *blue])
    expected = [red] * 4 + [blue] + [red] * 3 + [blue]
    assert decode(data, rows=1, width=9)[0].tolist() == expected
    # 1 1 1 0 1 1 1 1 counts 256
    data = as_array([*red, 1, 1, 1, 0, 1, 1, 1, 1, *blue])
    assert decode(data, rows=1, width=258)[0].tolist() == [red] * 257 + [blue]


def test_old_and_new_scanlines_may_mix():
    pixel = np.array([200, 10, 20, 130], dtype=np.uint8)
    line = np.tile(pixel, (1, 20, 1))
    old = bytes([*pixel, 1, 1, 1, 19])
    data = as_array(encode(line) + old + encode(line) + encode(line))
    assert np.array_equal(decode(data, rows=4, width=20), np.tile(line, (4, 1, 1)))


@pytest.mark.parametrize(
    ("data", "words"),
    [
        ([], "ends within a scanline"),
        ([2, 2, 0, 10], "ends within a scanline"),
        ([2, 2, 0, 10, 138, 7, 138, 7, 138, 7], "ends within a scanline"),
        ([2, 2, 0, 11, 138], "as in the header"),
        ([2, 2, 0, 10, 139, 7, 138, 7, 138, 7, 138, 7], "exceeds its scanline"),
        ([1, 1, 1, 10], "exceeds its scanline"),
        ([200, 1, 1, 130, 1, 1, 1, 200], "exceeds its scanline"),
        ([200, 1, 1, 130, 200, 1, 1], "ends within a scanline"),
    ],
)
def test_broken_scanlines_are_refused(data, words):
    with pytest.raises(InputError, match=words):
        decode(as_array(data), rows=1, width=10)


@given(
    st.lists(BYTES, max_size=120),
    st.integers(1, 3),
    st.sampled_from([1, 7, 8, 10]),
    st.booleans(),
)
@settings(max_examples=300)
def test_any_bytes_are_read_or_refused(data, rows, width, with_head):
    head = [2, 2, 0, width] if with_head else []
    with contextlib.suppress(InputError):
        pixels = decode(as_array(head + data), rows=rows, width=width)
        assert pixels.shape == (rows, width, 4)


def test_a_long_stretch_of_empty_codes_ends_soon():
    data = as_array([2, 2, 0, 10] + [0] * 100_000)
    with pytest.raises(InputError):
        decode(data, rows=1, width=10)


@pytest.mark.parametrize("block", [1, 25, 1000])
def test_scanlines_are_decoded_in_blocks(monkeypatch, block):
    """Of the new and the old form, of bytes and of runs."""
    rng = np.random.default_rng(4)
    pixels = rng.integers(3, 6, (30, 12, 4)).repeat(3, axis=1).astype(np.uint8)
    monkeypatch.setattr(run_length, "_BLOCK", block)
    new, flat = encode(pixels), pixels.tobytes()
    old = np.insert(pixels[:, ::3].reshape(-1, 4), range(1, 361), (1, 1, 1, 2), axis=0)
    for data in (new, flat, old.tobytes()):
        assert np.array_equal(decode(as_array(data), rows=30, width=36), pixels)
