"""CSV text has the digits of repr for every number there is."""

from __future__ import annotations

import math
import sys

import numpy as np
import pytest

from laconic.csv_text import csv_text, power_of_ten


def written(numbers: np.ndarray) -> list[str]:
    return "".join(csv_text(np.asarray(numbers, float).reshape(-1, 1))).splitlines()


def expected(numbers: np.ndarray) -> list[str]:
    return [repr(number) for number in np.asarray(numbers, float).tolist()]


def test_random_bits_are_written_as_repr_writes_them():
    bits = np.random.default_rng(1).integers(0, 2**64, 100_000, dtype=np.uint64)
    numbers = bits.view(np.float64)
    assert written(numbers) == expected(numbers)


@pytest.mark.parametrize("numbers", [
    [0.0, -0.0, math.inf, -math.inf, math.nan, 5e-324, -1e-323, 2.2250738585072014e-308, 2.225073858507201e-308,
     1.7976931348623157e308, 1e22, 1e23, 9007199254740993.0, 123456789012345680.0, 0.1, 1 / 3, 2 / 3, -1.5, 9.5e-05],
    [10.0**k for k in range(-323, 309)], [2.0**k for k in range(-1074, 1024)],
    [math.nextafter(2.0**k, 0.0) for k in range(-1022, 1024)], [k * 1e-3 for k in range(20_000)],
    [float(2**k - 1) for k in range(1, 64)], [float(np.float32(k * 0.1)) for k in range(1000)],
    [k * 5e-324 for k in range(1, 3000)]], ids=["special", "tens", "twos", "below twos", "times", "whole", "single",
                                                "subnormal"])
def test_numbers_at_every_border_are_written_as_repr_writes_them(numbers):
    assert written(numbers) == expected(numbers)


def test_rows_have_commas_between_and_line_ends_after():
    table = np.array([[1.0, 2.5], [1e-9, -3.0]])
    assert "".join(csv_text(table)) == "1.0,2.5\n1e-09,-3.0\n"


def test_powers_of_ten_have_their_highest_bit_set():
    for k in (-292, -1, 0, 1, 55, 56, 324):
        assert power_of_ten(k).bit_length() == 128
    assert power_of_ten(-1) == (2**131 + 9) // 10


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
