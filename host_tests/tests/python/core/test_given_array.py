"""An array that a program gives: real numbers of the shape that is asked for, else one line with name, shape, unit."""

from __future__ import annotations

from decimal import Decimal

import numpy as np
import pytest

from laconic.core.given_array import AtLeast, real_array
from laconic.errors import BadInput


def test_what_fits_is_taken_without_a_copy_and_other_types_are_converted():
    there = np.arange(6.0).reshape(2, 3)
    assert np.shares_memory(real_array("a", there, (2, 3)), there)
    assert real_array("a", [[1, 2, 3]], ("samples", 3)).dtype == float
    assert real_array("a", np.float32([1, 2]), (AtLeast(2),), dtype=np.float64).tolist() == [1.0, 2.0]
    assert real_array("a", there.T, (3, 2)).flags.c_contiguous
    assert real_array("a", 2, ()).shape == ()
    assert real_array("a", [], (0,)).shape == (0,)


@pytest.mark.parametrize("given", [None, "x", [1, None], [1j, 2], [True, False], [[1], [1, 2]], [1], [1, 2, 3], {1: 2},
                                   [Decimal(1), Decimal(2)], [10**400, 1], object()])
def test_what_is_no_such_array_is_refused_by_its_name(given):
    with pytest.raises(BadInput, match=r"^volts: .* does not fit; give real numbers of shape \(2,\) in V$"):
        real_array("volts", given, (2,), "V")


def test_the_first_place_that_is_not_finite_is_named():
    with pytest.raises(BadInput, match=r"^a\[2, 1\]: nan is not finite; give finite numbers in m$"):
        real_array("a", [[1, 2], [np.nan, np.inf]], (2, 2), "m")
    assert np.isnan(real_array("a", [np.nan], (1,), is_finite=False)[0])


def test_a_number_too_large_for_single_precision_becomes_infinite_without_a_warning():
    assert real_array("a", [1e300], (1,), dtype=np.float32)[0] == np.inf
