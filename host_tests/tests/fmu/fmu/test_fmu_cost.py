"""What the calls of an FMU cost beside the core's step, in instructions: the same on every run."""

from __future__ import annotations

import pytest

from laconic.base.paths import built
from laconic.tools.report.counting import cachegrind_present, instructions_of

STEPS = 2000
MOST = 560  # instructions to set four voltages, take the step, and get ν, position and heading, without the core's step


def instructions_a_step(loop: str) -> float:
    """I(2n) − I(n) over n: loading and start cancel."""
    program = [str(built(f"fmu/{name}")) for name in (
        "laconic_fmu_overhead", "Laconic/fmi2/Laconic.so", "Laconic/fmi3/Laconic.so", "liblaconic_fmu_minimal.so")]
    once, twice = (instructions_of([*program, "--count", loop, str(steps)]) for steps in (STEPS, 2 * STEPS))
    return (twice - once) / STEPS


@pytest.mark.nightly
@pytest.mark.skipif(not cachegrind_present(), reason="valgrind is not installed")
def test_the_calls_of_a_step_cost_less_than_the_step(capsys: pytest.CaptureFixture[str]):
    core, least = instructions_a_step("core"), instructions_a_step("minimal")
    for version in (2, 3):
        glue = instructions_a_step(f"fmi{version}") - core
        with capsys.disabled():
            print(f"\nFMI {version}: {glue:.0f} instructions beyond the core's {core:.0f}; a minimal FMU: {least:.0f}")
        assert least < glue < MOST
