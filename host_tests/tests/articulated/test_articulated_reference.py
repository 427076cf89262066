"""Articulated vehicles against reference trajectories that were computed to 25 digits."""

from __future__ import annotations

import json
from pathlib import Path

import pytest
from articulated_runner import Case, trajectory

CASES = json.loads((Path(__file__).parents[1] / "data" / "articulated_reference.json").read_text())["cases"]
NAMES = [case["name"] for case in CASES]


def errors(case: Case, rows: list[list[float]]) -> dict[str, float]:
    """The largest error of each kind over the states, over the largest number of that kind (at least 1)."""
    hinges, wheels = len(case["vehicle"]["bodies"]) - 1, len(case["vehicle"]["wheels"])
    kinds = {"velocity": 3, "pose": 3, "psi": hinges, "hinge_rate": hinges, "wheel_speed": wheels, "chi": wheels}
    worst, size = dict.fromkeys(kinds, 0.0), dict.fromkeys(kinds, 1.0)
    assert len(rows) == len(case["states"])
    for row, state in zip(rows, case["states"], strict=True):
        at = 1
        for kind, count in kinds.items():
            for got, text in zip(row[at:at + count], state[kind], strict=True):
                worst[kind] = max(worst[kind], abs(got - float(text)))
                size[kind] = max(size[kind], abs(float(text)))
            at += count
    return {kind: worst[kind] / size[kind] for kind in kinds}


def assert_errors(case: Case, method: str, step_s: float, limit: float, real: str = "double") -> None:
    found = errors(case, trajectory(case, method, step_s, real))
    assert max(found.values()) <= limit, {kind: f"{error:.1e}" for kind, error in found.items()}


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_auto_meets_the_reference_at_1_ms(case: Case) -> None:
    assert_errors(case, "auto", 1e-3, 1e-9)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_auto_meets_the_reference_at_10_ms(case: Case) -> None:
    assert_errors(case, "auto", 1e-2, 1e-5)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
@pytest.mark.parametrize("method", ["rk4", "circle", "moebius-4"])
def test_every_method_meets_the_reference(case: Case, method: str) -> None:
    assert_errors(case, method, 1e-3, 5e-9)
    assert_errors(case, method, 1e-2, 1e-5)


@pytest.mark.parametrize("case", CASES, ids=NAMES)
def test_single_precision_meets_the_reference(case: Case) -> None:
    assert_errors(case, "auto", 1e-2, 1e-4, "single")
