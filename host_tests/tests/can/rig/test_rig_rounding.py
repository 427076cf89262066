"""A node that rounds as its own numbers do is right, in double and in single precision."""

from __future__ import annotations

import numpy as np
import pytest

from laconic.can.rig.boards import own_node
from laconic.can.rig.judge import judge_scaled
from laconic.can.rig.scaled import rounding_limit
from laconic.scene import read_scene


def as_the_node_rounds(value: np.ndarray, per_unit: int) -> np.ndarray:
    """node_pack.c: scaled and rounded half away from zero in the scalar type."""
    raw = value * value.dtype.type(per_unit)
    return np.trunc(raw + np.copysign(value.dtype.type(0.5), raw)).astype(np.int64)


@pytest.mark.parametrize("real", ["float32", "float64"])
@pytest.mark.parametrize(("per_unit", "largest"), [(200, 163.0), (1000, 32.0), (10000, 3.14)])
def test_whatever_the_node_rounds_is_within_the_rounding_limit(real: str, per_unit: int, largest: float) -> None:
    values = np.random.default_rng(7).uniform(-largest, largest, 400_000).astype(real)
    exact = values.astype(float) * per_unit
    off = np.abs(as_the_node_rounds(values, per_unit) - exact)
    assert np.all(off <= rounding_limit(exact, np.dtype(real)))
    assert np.max(off) > 0.499  # a limit below 0.5 would be too small


def test_the_rounding_limit_stays_half_where_numbers_are_fine() -> None:
    assert rounding_limit(32767.0, np.dtype("float64")) < 0.50001
    assert rounding_limit(32767.0, np.dtype("float32")) < 0.505


def test_a_long_run_of_a_node_in_single_precision_passes() -> None:
    scene = read_scene("turtlebot3_burger").with_run(real="single")
    with own_node("virtual", "single") as node:
        assert judge_scaled(node, scene, 6100, {}).passed  # its heading was "wrong" at step 6037
