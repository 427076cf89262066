"""CSV text reads back as the same numbers, every bit."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from laconic.simulation.csv_text import ROWS_AT_ONCE, csv_text


def read_back(table: np.ndarray) -> np.ndarray:
    lines = "".join(csv_text(table)).splitlines()
    return np.array([[float(cell) for cell in line.split(",")] for line in lines])


def assert_same_bits(table: np.ndarray) -> None:
    assert read_back(table).view(np.uint64).tolist() == table.view(np.uint64).tolist()


def test_random_bits_read_back_as_they_were():
    bits = np.random.default_rng(1).integers(0, 2**64, (ROWS_AT_ONCE + 5, 4), dtype=np.uint64)
    numbers = bits.view(np.float64)
    assert_same_bits(np.where(np.isfinite(numbers), numbers, 1.0))


@pytest.mark.parametrize("numbers", [
    [0.0, -0.0, 5e-324, -1e-323, 2.2250738585072014e-308, 1.7976931348623157e308, 1e22, 1e23, 0.1, 1 / 3],
    [10.0**k for k in range(-323, 309)], [2.0**k for k in range(-1074, 1024)], [k * 1e-3 for k in range(2000)]],
    ids=["special", "tens", "twos", "times"])
def test_numbers_at_every_border_read_back_as_they_were(numbers):
    assert_same_bits(np.array(numbers)[:, None])


def test_no_number_has_more_digits_than_it_needs():
    assert "".join(csv_text(np.array([[0.1, 2.5, 1.0 / 3.0, -3.0]]))) == "0.1,2.5,0.3333333333333333,-3.0\n"


def test_what_is_no_finite_number_is_written_as_python_writes_it():
    assert "".join(csv_text(np.array([[math.nan, 1.5], [-math.inf, math.inf]]))) == "nan,1.5\n-inf,inf\n"


def test_rows_have_commas_between_and_line_ends_after():
    assert "".join(csv_text(np.array([[1.0, 2.5], [0.25, -3.0]]))) == "1.0,2.5\n0.25,-3.0\n"
    assert not list(csv_text(np.zeros((0, 3))))


def test_a_number_more_is_no_python_call_more():
    def calls(rows: int) -> int:
        count = 0

        def note(*_: object) -> None:
            nonlocal count
            count += 1

        table = np.full((rows, 10), 0.1)
        sys.setprofile(note)
        try:
            list(csv_text(table))
        finally:
            sys.setprofile(None)
        return count

    calls(1)
    assert calls(4000) == calls(10)
