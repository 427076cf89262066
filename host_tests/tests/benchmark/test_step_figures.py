"""Instructions, stack and bytes of an rk4 step stay where docs/performance.md says they are: the same on every run."""

from __future__ import annotations

import pytest

from laconic.benchmark.boards import board_row
from laconic.benchmark.counting import cachegrind_present, host_instructions
from laconic.benchmark.workshop import HOST, M4F, Variant, Workshop
from laconic.scene import read_scene

HOST_MOST = {("double", "whole"): 593, ("double", "trimmed"): 585, ("single", "whole"): 575}
BOARD_MOST = {"instructions": 461, "stack_measured": 168, "worst_stack": 520, "step_code": 4640}  # bytes; whole, -O2

needs_counter = pytest.mark.skipif(not (HOST.present and cachegrind_present()), reason="no gcc or no valgrind")
needs_board = pytest.mark.skipif(not (M4F.present and HOST.present), reason="no gcc or QEMU for Cortex-M")


@pytest.fixture(scope="module")
def workshop(tmp_path_factory: pytest.TempPathFactory) -> Workshop:
    return Workshop(tmp_path_factory.mktemp("figures"))


def rk4(real: str, *, trim: bool, step_s: float) -> Variant:
    return Variant(read_scene("s1").with_run(method="rk4", step_s=step_s), real, "-O2", trim)


@needs_counter
@pytest.mark.parametrize(("real", "build"), list(HOST_MOST))
def test_instructions_of_a_step_on_the_host(workshop: Workshop, capsys: pytest.CaptureFixture[str], real: str,
                                            build: str):
    found = host_instructions(workshop.host_program(rk4(real, trim=build == "trimmed", step_s=0.01)))
    with capsys.disabled():
        print(f"\nrk4, {real}, {build}: {found:.1f} instructions a step")
    assert 400 < found < HOST_MOST[real, build]


@needs_board
def test_figures_of_a_step_on_a_cortex_m4f(workshop: Workshop, capsys: pytest.CaptureFixture[str]):
    row = board_row(workshop, M4F, rk4("single", trim=False, step_s=0.001))
    with capsys.disabled():
        print("\nrk4, Cortex-M4F: " + ", ".join(f"{name} {row[name]}" for name in BOARD_MOST))
    assert row["same_bits"]
    for name, most in BOARD_MOST.items():
        assert 0 < row[name] <= most, name
