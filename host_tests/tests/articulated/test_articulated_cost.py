"""What a step of a vehicle with hinges costs, in steps of a vehicle without them and with as many wheels.

On ideal ground these are steps of rk4, on ground with friction those of its own step.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import cache
from typing import Any

import pytest

from laconic.base.paths import built
from laconic.tools.report.counting import cachegrind_present, instructions_of

LIMITS = {"casters-1": (3, 5.0), "casters-2": (4, 7.5), "tricycle-motor": (3, 8.0), "tricycle-prescribed": (3, 8.0),
          "ackermann": (4, 9.0), "swerve": (4, 12.0), "trailers-3": (6, 16.5)}


def each(limits: Iterable[str]) -> list[Any]:
    """The vehicles with casters ordinarily, all others at night."""
    return [name if name.startswith("casters") else pytest.param(name, marks=pytest.mark.nightly) for name in limits]


@cache
def cost(program: str, words: tuple[str, ...], least: int, most: int) -> float:
    """Instructions of a step; what the counts of both runs have in common cancels."""
    few, many = (instructions_of([str(built(f"bin/{program}")), *words, str(steps)]) for steps in (least, most))
    return (many - few) / (most - least)


def step_cost(vehicle: str, method: str) -> float:
    return cost("count_articulated", (vehicle, method), 500, 1000)


@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
@pytest.mark.parametrize("vehicle", each(LIMITS))
def test_a_step_of_rk4_costs_at_most_so_many_plain_steps(capsys: pytest.CaptureFixture[str], vehicle: str) -> None:
    wheels, limit = LIMITS[vehicle]
    plain, step = step_cost(f"plain-{wheels}", "rk4"), step_cost(vehicle, "rk4")
    with capsys.disabled():
        print(f"\n{vehicle}: {step:.0f} instructions, {step / plain:.2f} plain steps of {plain:.0f}")
    assert step / plain < limit


# ------------------------------------------------------------------------------- on ground with friction

FRICTION_LIMITS = {"rigid": 1.2, "casters": 1.5, "loader": 1.4, "ackermann": 1.95, "swerve": 2.65}


def friction_step_cost(vehicle: str) -> float:
    return cost("count_tree", (vehicle,), 1000, 3000)


@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
@pytest.mark.parametrize("vehicle", each(FRICTION_LIMITS))
def test_a_step_on_ground_with_friction_costs_at_most_so_many_rigid_ones(capsys: pytest.CaptureFixture[str],
                                                                         vehicle: str) -> None:
    plain, step = friction_step_cost("plain"), friction_step_cost(vehicle)
    with capsys.disabled():
        print(f"\n{vehicle}: {step:.0f} instructions, {step / plain:.2f} rigid friction steps of {plain:.0f}")
    assert step / plain < FRICTION_LIMITS[vehicle]
