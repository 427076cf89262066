"""What a step of a vehicle with hinges on ground with friction costs, in steps of a rigid one with as many wheels."""

from __future__ import annotations

from functools import cache

import pytest

from laconic.base.paths import built
from laconic.tools.report.counting import cachegrind_present, instructions_of

LEAST, MOST = 1000, 3000  # steps: what a count of one run has in common with another's cancels
LIMITS = {"rigid": 1.5, "casters": 1.8, "loader": 1.8, "ackermann": 2.4, "swerve": 3.15}


@cache
def step_cost(vehicle: str) -> float:
    program = str(built("bin/count_tree"))
    least, most = (instructions_of([program, vehicle, str(steps)]) for steps in (LEAST, MOST))
    return (most - least) / (MOST - LEAST)


@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
@pytest.mark.parametrize("vehicle", LIMITS)
def test_a_step_costs_at_most_so_many_rigid_steps(capsys: pytest.CaptureFixture[str], vehicle: str) -> None:
    plain, step = step_cost("plain"), step_cost(vehicle)
    with capsys.disabled():
        print(f"\n{vehicle}: {step:.0f} instructions, {step / plain:.2f} rigid steps of {plain:.0f}")
    assert step / plain < LIMITS[vehicle]
