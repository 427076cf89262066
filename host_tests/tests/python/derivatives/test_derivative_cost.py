"""What all Jacobians of a step cost beside the step, in instructions: the same on every run."""

from __future__ import annotations

import pytest

from laconic.base.paths import built
from laconic.scene.methods import STIFF_8
from laconic.tools.report.counting import cachegrind_present, instructions_of
from laconic.tools.verify.exact.trials import METHODS

pytestmark = pytest.mark.nightly

FEW, MANY = 100, 300  # calls: what a count of one run has in common with another's cancels
LIMIT = 6.0           # steps
LIMITS = {STIFF_8: 6.6}  # rounds at four nodes, in which a direction costs as much as the step


def cost(method: str, what: str) -> float:
    """Instructions of one step, or of one answer about it."""
    program = str(built("bin/count_derivatives"))
    few, many = (instructions_of([program, method, what, str(calls)]) for calls in (FEW, MANY))
    return (many - few) / (MANY - FEW)


@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
@pytest.mark.parametrize("method", METHODS)
def test_all_jacobians_by_state_and_input_cost_no_more_steps_than_the_limit(capsys, method):
    step, jacobian = cost(method, "step"), cost(method, "jacobian")
    with capsys.disabled():
        print(f"\n{method}: {step:.0f} instructions a step, its Jacobians {jacobian:.0f}, {jacobian / step:.2f} steps")
    assert jacobian / step <= LIMITS.get(method, LIMIT)
