"""What a recorded row costs beside a step, in instructions: the same on every run."""

from __future__ import annotations

from functools import cache

import pytest

from laconic.base.paths import built
from laconic.tools.report.counting import cachegrind_present, instructions_of

LEAST, MOST = 1000, 3000  # steps: what a count of one run has in common with another's cancels
LIMIT = 20.0              # rows cost at most so many steps

needs_cachegrind = pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")


@cache
def cost(kind: str, every: int, watch: int) -> float:
    """Instructions for each step, rows and watch included."""
    program = str(built("bin/count_record"))
    least, most = (instructions_of([program, kind, str(every), str(watch), str(steps)]) for steps in (LEAST, MOST))
    return (most - least) / (MOST - LEAST)


@needs_cachegrind
@pytest.mark.parametrize(("watch", "what"), [(0, "without the ground"), (1, "with the no-slip margin")])
def test_a_row_costs_at_most_twenty_steps(capsys, watch, what):
    step = cost("held", 0, 0)
    row = cost("held", 1, watch) - step
    with capsys.disabled():
        print(f"\na row {what}: {row:.0f} instructions, {row / step:.1f} steps of {step:.0f}")
    assert row / step < LIMIT


@needs_cachegrind
def test_watching_the_ground_costs_at_most_twenty_steps_and_nothing_where_it_is_off(capsys):
    step, watched = cost("held", 0, 0), cost("held", 0, 2)
    with capsys.disabled():
        print(f"\na watched step: {watched / step:.1f} steps; unwatched: {cost('held', 0, 1) / step:.3f}")
    assert watched / step < LIMIT
    assert cost("held", 0, 1) == pytest.approx(step, rel=0.01)


@needs_cachegrind
def test_a_sampled_step_costs_at_most_twenty_held_ones(capsys):
    step, sampled = cost("held", 0, 0), cost("sampled", 0, 0)
    with capsys.disabled():
        print(f"\na sampled step: {sampled / step:.1f} held ones")
    assert sampled / step < LIMIT
