"""The compiled reader of rows gives NumPy's numbers to the last bit, or leaves the text to the general reader."""

import io

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from qmd_studio.formats import bvh_numbers
from qmd_studio.formats.number_kernel import parse_even_rows

number = st.one_of(
    st.floats(allow_nan=False, allow_infinity=False).map(repr),
    st.decimals(allow_nan=False, allow_infinity=False, places=6, min_value=-(10**6), max_value=10**6).map(str),
    st.from_regex(
        r"\A[+-]?(?:[0-9]{1,30}\.?[0-9]{0,30}|\.[0-9]{1,30})(?:[eE][+-]?[0-9]{1,2})?\Z", fullmatch=True
    ).filter(str.isascii),
)


@settings(max_examples=300, deadline=None)
@given(st.lists(number, min_size=1, max_size=6), st.integers(1, 40), st.sampled_from(["\n", "\r\n", "\r", "\n\n"]))
def test_numbers_are_numpys_to_the_last_bit(words, repeats, line_end):
    rows = [["0.5", "-1.25e2", "3"] * 8 + words] * repeats
    text = line_end.join(" ".join(row) for row in rows)
    wanted = np.loadtxt(io.StringIO(text.replace(line_end, "\n")), ndmin=2)
    matrix = parse_even_rows(text.encode(), len(rows[0]))
    if matrix is None:  # too many that need care
        assert len(words) > 1
    else:
        np.testing.assert_array_equal(matrix, wanted)
        np.testing.assert_array_equal(np.signbit(matrix), np.signbit(wanted))


def test_plain_rows_are_not_left_to_the_general_reader():
    np.testing.assert_array_equal(parse_even_rows(b"1 -2.5\n\t.5   4e-3 \n", 2), [[1, -2.5], [0.5, 0.004]])


@pytest.mark.parametrize(
    "text",
    [
        "1 2\n3",
        "1 2 3\n",
        "1 x\n",
        "1 nan\n",
        "1 1e999\n",
        "1 1e\n",
        "1 1e+\n",
        "1 -\n",
        "1 .\n",
        "1 1,5\n",
        "1 2.3.4\n",
        "1 0x1\n",
        "1 1_0\n",
        "1 2\0\n",
        "1\n2\n",
        "1 -",
        "1 2e",
    ],
)
def test_anything_else_is_left_to_the_general_reader(text):
    assert parse_even_rows(text.encode(), 2) is None


def test_a_large_file_reads_the_same_either_way(monkeypatch):
    values = np.random.default_rng(2).normal(size=(300, 7)) * 100
    block = "\n".join(" ".join(map("{:.5f}".format, row)) for row in values).encode()
    general = bvh_numbers.parse_rows(block, 7)
    monkeypatch.setattr(bvh_numbers, "_LARGE_BYTES", 1)
    compiled = bvh_numbers.parse_rows(block, 7)
    np.testing.assert_array_equal(compiled.values, general.values)
    broken = bvh_numbers.parse_rows(block.replace(b"\n", b" \n ", 5) + b"\n1 2", 7)
    assert (len(broken.values), broken.left_over) == (300, 2)
